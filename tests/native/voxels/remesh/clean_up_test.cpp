// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/voxels/remesh/clean_up.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <random>
#include <set>

#include "prefilter/base/error.h"
#include "prefilter/geometry/spatial/triangle_point.h"
#include "prefilter/voxels/grid_contour.h"
#include "prefilter/voxels/remesh/intersections.h"
#include "voxels/contour/mesh_checks.h"

namespace prefilter {
namespace {

using testing::fault_of;
using testing::volume_of;
using Triangle = std::array<std::int32_t, 3>;

// The contour of a function that is 1 inside and 0 outside, on cells from 0 to `size`.
template <typename Function>
FacetedMesh contour_of(int size, const Function& function) {
  std::vector<float> values;
  for (int i = 0; i < size * size * size; ++i) {
    const double value = function(i / (size * size), i / size % size, i % size);
    values.push_back(static_cast<float>(std::clamp(value, 0.0, 1.0)));
  }
  ContourOptions options;
  options.clean_up = false;
  TriangleMesh mesh = contour_grid({values.data(), {size, size, size}}, {}, options);
  return {std::move(mesh.positions), std::move(mesh.triangles), {}, {}};
}

FacetedMesh sphere(int size) {
  const double radius = 0.4 * size;
  return contour_of(size, [&](int x, int y, int z) {
    return radius - std::hypot(x - 0.51 * size, y - 0.49 * size, z - 0.505 * size) + 0.5;
  });
}

TriangleMesh plain(const FacetedMesh& mesh) { return {mesh.positions, mesh.triangles}; }

double smallest_angle(const FacetedMesh& mesh, std::size_t triangle) {
  double least = 180.0;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto at = [&](std::size_t k) {
      return mesh.positions[static_cast<std::size_t>(mesh.triangles[triangle][(i + k) % 3])];
    };
    const Vector3 u = at(1) - at(0);
    const Vector3 v = at(2) - at(0);
    const double angle = std::atan2(length(cross(u, v)), dot(u, v));
    least = std::min(least, angle * 180.0 / std::numbers::pi);
  }
  return least;
}

double narrow_share(const FacetedMesh& mesh) {
  std::size_t count = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (smallest_angle(mesh, t) < 15.0) ++count;
  }
  return static_cast<double>(count) / static_cast<double>(mesh.triangles.size());
}

bool are_some_of(const std::vector<Vector3>& some, const std::vector<Vector3>& all) {
  const std::set<Vector3> known(all.begin(), all.end());
  return std::all_of(some.begin(), some.end(), [&](const Vector3& p) { return known.contains(p); });
}

TEST(CleanUp, KeepsTheShapeAndWidensAngles) {
  const FacetedMesh before = sphere(24);
  const FacetedMesh after = clean_up(before, {0.01}, prefilter::Run(1));
  EXPECT_EQ(fault_of(plain(after)), "");
  EXPECT_NEAR(volume_of(plain(after)), volume_of(plain(before)), 0.005 * volume_of(plain(before)));
  EXPECT_GT(narrow_share(before), 0.1);
  EXPECT_LT(narrow_share(after), 0.005);
  EXPECT_TRUE(are_some_of(after.positions, before.positions));
}

TEST(CleanUp, IsTheSameForAnyNumberOfThreads) {
  const FacetedMesh before = sphere(150);  // several patches
  const FacetedMesh after = clean_up(before, {0.01}, prefilter::Run(1));
  EXPECT_LT(narrow_share(after), 0.001);
  EXPECT_EQ(fault_of(plain(after)), "");
  for (const int threads : {2, 3}) {
    const FacetedMesh other = clean_up(before, {0.01}, prefilter::Run(threads));
    EXPECT_EQ(other.positions, after.positions);
    EXPECT_EQ(other.triangles, after.triangles);
  }
}

TEST(CleanUp, AddsNoIntersectionsToNoise) {
  // Surfaces less than a cell apart: some of the first changes make them intersect, within the
  // single patch for all seeds but 2.
  for (const unsigned seed : {1U, 2U, 5U, 7U}) {
    std::mt19937 random(seed);
    const FacetedMesh before = contour_of(24, [&](int x, int y, int z) {
      const double value = static_cast<double>(random()) / 4294967296.0;
      const auto [low, high] = std::minmax({x, y, z});
      return low < 2 || high > 21 ? 0.0 : value;
    });
    ASSERT_TRUE(intersecting_triangles({before.positions, before.triangles}, {}, prefilter::Run(2))
                    .empty());
    const FacetedMesh after = clean_up(before, {0.01}, prefilter::Run(2));
    EXPECT_EQ(fault_of(plain(after)), "");
    EXPECT_LT(after.triangles.size(), before.triangles.size());
    EXPECT_TRUE(
        intersecting_triangles({after.positions, after.triangles}, {}, prefilter::Run(2)).empty());
    EXPECT_EQ(clean_up(before, {0.01}, prefilter::Run(1)).triangles, after.triangles);
  }
}

TEST(CleanUp, MakesNoSecondEdgeBetweenTwoVertices) {
  // A low roof around vertex 0 over a rhombus; the rhombus's best diagonal is an edge of the
  // bottom.
  FacetedMesh before;
  before.positions = {{0, 0, 0.005}, {-1, 0, 0},    {0, -0.1, 0}, {1, 0, 0},
                      {0, 0.1, 0},   {-0.4, 0, -3}, {0.4, 0, -3}};
  before.triangles = {{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 1}, {2, 1, 5},
                      {1, 4, 5}, {4, 2, 5}, {3, 2, 6}, {2, 4, 6}, {4, 3, 6}};
  ASSERT_EQ(fault_of(plain(before)), "");
  EXPECT_EQ(fault_of(plain(clean_up(before, {0.01}, prefilter::Run(1)))), "");
}

TEST(CleanUp, KeepsATetrahedron) {
  FacetedMesh thin;
  thin.positions = {{0, 0, 0}, {1, 0, 0}, {0, 0.01, 0}, {0.5, 0, 1}};
  thin.triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
  EXPECT_EQ(clean_up(thin, {0.01}, prefilter::Run(1)).triangles, thin.triangles);
  EXPECT_TRUE(clean_up({}, {0.01}, prefilter::Run(2)).triangles.empty());
}

TEST(CleanUp, IsTheSameAtAnyScale) {
  const FacetedMesh before = sphere(20);
  const FacetedMesh after = clean_up(before, {0.01}, prefilter::Run(1));
  for (const double scale : {0x1p-200, 0x1p200}) {
    FacetedMesh scaled = before;
    for (Vector3& p : scaled.positions) p = {scale * p[0], scale * p[1], scale * p[2]};
    EXPECT_EQ(clean_up(scaled, {0.01 * scale}, prefilter::Run(1)).triangles, after.triangles);
  }
}

// A prism along z. Each side is rows of squares with vertices at uneven heights and a label of its
// own; there are creases between sides and corners at the ends. The triangles of each end meet in
// its center.
struct Prism {
  FacetedMesh mesh;
  std::vector<Vector3> directions;  // of the creases from the axis
};

Prism prism(const std::vector<double>& heights, int sides, double bulge) {
  Prism made;
  const auto count = static_cast<std::int32_t>(heights.size());
  for (int side = 0; side < sides; ++side) {
    const double angle = 2.0 * std::numbers::pi * side / sides;
    made.directions.push_back({std::cos(angle), std::sin(angle), 0.0});
  }
  FacetedMesh& mesh = made.mesh;
  // Columns alternate between a crease and the middle of the side after it.
  for (int column = 0; column < 2 * sides; ++column) {
    const auto side = static_cast<std::size_t>(column / 2);
    const Vector3& a = made.directions[side];
    const Vector3& b = made.directions[(side + 1) % made.directions.size()];
    for (std::int32_t row = 0; row < count; ++row) {
      const double z = heights[static_cast<std::size_t>(row)];
      const bool is_crease = column % 2 == 0;
      Vector3 p = is_crease ? a : 0.5 * (a + b);
      p[0] *= 1.0 + (is_crease ? bulge * (row % 2) : 0.0);
      p[2] = z;
      mesh.positions.push_back(p);
      const bool is_end = row == 0 || row + 1 == count;
      mesh.kinds.push_back(is_end && is_crease   ? VertexKind::kCorner
                           : is_end || is_crease ? VertexKind::kEdge
                                                 : VertexKind::kSurface);
    }
  }
  const std::int32_t columns = 2 * sides;
  for (std::int32_t column = 0; column < columns; ++column) {
    const std::int32_t next = (column + 1) % columns;
    for (std::int32_t row = 0; row + 1 < count; ++row) {
      const std::int32_t a = column * count + row;
      const std::int32_t b = next * count + row;
      mesh.triangles.push_back({a, b, b + 1});
      mesh.triangles.push_back({a, b + 1, a + 1});
      mesh.labels.insert(mesh.labels.end(), 2, column / 2);
    }
  }
  for (const bool is_top : {false, true}) {
    const auto middle = static_cast<std::int32_t>(mesh.positions.size());
    mesh.positions.push_back({0.0, 0.0, is_top ? heights.back() : heights.front()});
    mesh.kinds.push_back(VertexKind::kSurface);
    for (std::int32_t column = 0; column < columns; ++column) {
      const std::int32_t a = column * count + (is_top ? count - 1 : 0);
      const std::int32_t b = (column + 1) % columns * count + (is_top ? count - 1 : 0);
      mesh.triangles.push_back(is_top ? std::array{middle, a, b} : std::array{middle, b, a});
      mesh.labels.push_back(sides + (is_top ? 1 : 0));
    }
  }
  return made;
}

std::vector<double> uneven_heights() {
  std::vector<double> heights = {0.0};
  for (int i = 0; i < 40; ++i) heights.push_back(heights.back() + (i % 3 == 0 ? 0.02 : 0.4));
  return heights;
}

// The area of each label.
std::map<std::int32_t, double> areas_of(const FacetedMesh& mesh) {
  std::map<std::int32_t, double> areas;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto [a, b, c] = MeshView<std::int32_t>{mesh.positions, mesh.triangles}.corners(t);
    areas[mesh.labels.at(t)] += 0.5 * length(cross(b - a, c - a));
  }
  return areas;
}

TEST(CleanUp, KeepsStraightCreasesAndLabels) {
  const Prism made = prism(uneven_heights(), 5, 0.0);
  const FacetedMesh after = clean_up(made.mesh, {1e-6}, prefilter::Run(2));
  ASSERT_EQ(fault_of(plain(made.mesh)), "");
  EXPECT_EQ(fault_of(plain(after)), "");
  EXPECT_EQ(after.kinds.size(), after.positions.size());
  EXPECT_LT(after.positions.size(), made.mesh.positions.size() * 4 / 5);
  EXPECT_LT(narrow_share(after), 0.1 * narrow_share(made.mesh));
  EXPECT_NEAR(volume_of(plain(after)), volume_of(plain(made.mesh)), 1e-9);
  const auto before_areas = areas_of(made.mesh);
  const auto after_areas = areas_of(after);
  ASSERT_EQ(after_areas.size(), before_areas.size());
  for (const auto& [label, area] : before_areas) EXPECT_NEAR(after_areas.at(label), area, 1e-9);
}

TEST(CleanUp, MovesCreasesNoFartherThanAllowed) {
  const Prism made = prism(uneven_heights(), 5, 0.01);
  const auto crease_points = [](const FacetedMesh& mesh) {
    std::vector<Vector3> points;
    for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
      if (mesh.kinds[v] != VertexKind::kSurface) points.push_back(mesh.positions[v]);
    }
    std::sort(points.begin(), points.end());
    return points;
  };
  // Every other point of the crease at angle 0 protrudes by 0.01.
  const FacetedMesh kept = clean_up(made.mesh, {1e-4}, prefilter::Run(1));
  const FacetedMesh moved = clean_up(made.mesh, {0.05}, prefilter::Run(1));
  const auto out = [&](const FacetedMesh& mesh) {
    const std::vector<Vector3> points = crease_points(mesh);
    return std::count_if(points.begin(), points.end(),
                         [](const Vector3& p) { return std::abs(p[0] - 1.01) < 1e-12; });
  };
  EXPECT_EQ(out(kept), out(made.mesh));
  EXPECT_LT(out(moved), out(made.mesh));
  EXPECT_EQ(fault_of(plain(kept)), "");
  EXPECT_EQ(fault_of(plain(moved)), "");
}

// Largest distance of a mesh's vertices and edge midpoints from another mesh.
double largest_distance(const FacetedMesh& mesh, const FacetedMesh& other) {
  const MeshView<std::int32_t> view{other.positions, other.triangles};
  double largest = 0.0;
  for (const Triangle& triangle : mesh.triangles) {
    const Vector3& a = mesh.positions[static_cast<std::size_t>(triangle[0])];
    const Vector3& b = mesh.positions[static_cast<std::size_t>(triangle[1])];
    for (const Vector3& p : {a, 0.5 * (a + b)}) {
      double least = 1e30;
      for (std::size_t t = 0; t < other.triangles.size(); ++t) {
        const auto [u, v, w] = view.corners(t);
        const Vector3 weights = nearest_weights(p, u, v, w);
        const Vector3 off = p - (weights[0] * u + weights[1] * v + weights[2] * w);
        least = std::min(least, dot(off, off));
      }
      largest = std::max(largest, least);
    }
  }
  return std::sqrt(largest);
}

TEST(CleanUp, MovesTheSurfaceNoFartherThanAllowed) {
  const FacetedMesh before = sphere(12);
  const FacetedMesh free = clean_up(before, {0.01}, prefilter::Run(1));
  EXPECT_GT(largest_distance(before, free), 0.05);
  EXPECT_EQ(clean_up(before, {0.01, 0.0}, prefilter::Run(1)).triangles, before.triangles);
  double share = narrow_share(before);
  for (const double height : {0.003, 0.01}) {
    const FacetedMesh after = clean_up(before, {0.01, height}, prefilter::Run(1));
    // Two changes may overlap.
    EXPECT_LT(largest_distance(before, after), 2.0 * height);
    EXPECT_LT(largest_distance(after, before), 2.0 * height);
    EXPECT_LT(narrow_share(after), share);
    EXPECT_EQ(fault_of(plain(after)), "");
    share = narrow_share(after);
  }
}

TEST(CleanUp, KeepsCorners) {
  FacetedMesh before = sphere(24);
  before.kinds.assign(before.positions.size(), VertexKind::kCorner);
  const FacetedMesh after = clean_up(before, {1.0}, prefilter::Run(1));
  EXPECT_EQ(after.positions, before.positions);
}

TEST(CleanUp, CanBeCancelled) {
  const prefilter::Run run([](double) { return false; });
  EXPECT_THROW(clean_up(sphere(24), {0.01}, run.with_threads(2)), Error);
}

}  // namespace
}  // namespace prefilter
