// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/voxels/remesh/simplify.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <random>

#include "prefilter/base/error.h"
#include "prefilter/voxels/grid_contour.h"
#include "prefilter/voxels/remesh/intersections.h"
#include "voxels/contour/mesh_checks.h"

namespace prefilter {
namespace {

using testing::fault_of;
using testing::volume_of;

using Triangle = std::array<std::int32_t, 3>;

std::string fault_of(const FacetedMesh& mesh) {
  return testing::fault_of(TriangleMesh{mesh.positions, mesh.triangles});
}

double volume_of(const FacetedMesh& mesh) {
  return testing::volume_of(TriangleMesh{mesh.positions, mesh.triangles});
}

Vector3 corner(const FacetedMesh& mesh, std::size_t triangle, std::size_t i) {
  return mesh.positions[static_cast<std::size_t>(mesh.triangles[triangle][i])];
}

Vector3 scaled(double factor, const Vector3& v) {
  return {factor * v[0], factor * v[1], factor * v[2]};
}

// Distance between a point and a triangle: to its plane if the foot is in the triangle, else to its
// sides.
double distance_to(const Vector3& p, const Vector3& a, const Vector3& b, const Vector3& c) {
  const Vector3 n = cross(b - a, c - a);
  const Vector3 unit = scaled(1.0 / length(n), n);
  const double height = dot(p - a, unit);
  const Vector3 foot = p - scaled(height, unit);
  const std::array<Vector3, 3> corners = {a, b, c};
  double least = std::numeric_limits<double>::infinity();
  bool is_inside = true;
  for (std::size_t i = 0; i < 3; ++i) {
    const Vector3& from = corners[i];
    const Vector3 side = corners[(i + 1) % 3] - from;
    is_inside = is_inside && dot(cross(side, foot - from), unit) >= 0.0;
    const double along = std::clamp(dot(p - from, side) / dot(side, side), 0.0, 1.0);
    least = std::min(least, length(p - (from + scaled(along, side))));
  }
  return is_inside ? std::abs(height) : least;
}

// Largest distance of random points of one surface from another one, over all its triangles.
double largest_distance(const FacetedMesh& from, const FacetedMesh& to, std::size_t per_triangle) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  double largest = 0.0;
  const auto measure = [&](const Vector3& p) {
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t t = 0; t < to.triangles.size() && least > largest; ++t) {
      const std::array<Vector3, 3> c = {corner(to, t, 0), corner(to, t, 1), corner(to, t, 2)};
      double apart = 0.0;  // from its box
      for (std::size_t a = 0; a < 3; ++a) {
        const auto [low, high] = std::minmax({c[0][a], c[1][a], c[2][a]});
        apart = std::max({apart, low - p[a], p[a] - high});
      }
      if (apart < least) least = std::min(least, distance_to(p, c[0], c[1], c[2]));
    }
    largest = std::max(largest, least);
  };
  for (const Vector3& p : from.positions) measure(p);
  for (std::size_t t = 0; t < from.triangles.size(); ++t) {
    for (std::size_t k = 0; k < per_triangle; ++k) {
      const double u = uniform(random);
      const double v = k % 3 == 0 ? 0.0 : (1.0 - u) * uniform(random);
      measure(corner(from, t, 0) + scaled(u, corner(from, t, 1) - corner(from, t, 0)) +
              scaled(v, corner(from, t, 2) - corner(from, t, 0)));
    }
  }
  return largest;
}

// Contour of cell occupancies, which are sampled from a function that is positive inside.
template <typename Inside>
FacetedMesh contour_of(int size, Interpolant interpolant, const Inside& inside) {
  std::vector<float> values;
  constexpr int kAlong = 4;
  for (int i = 0; i < size * size * size; ++i) {
    const Vector3 low = {static_cast<double>(i / (size * size)),
                         static_cast<double>(i / size % size), static_cast<double>(i % size)};
    int count = 0;
    for (int k = 0; k < kAlong * kAlong * kAlong; ++k) {
      count +=
          inside(low + Vector3{(k / (kAlong * kAlong) + 0.5) / kAlong,
                               (k / kAlong % kAlong + 0.5) / kAlong, (k % kAlong + 0.5) / kAlong})
              ? 1
              : 0;
    }
    values.push_back(static_cast<float>(count) / (kAlong * kAlong * kAlong));
  }
  ContourOptions options;
  options.interpolant = interpolant;
  options.clean_up = false;
  TriangleMesh mesh = contour_grid({values.data(), {size, size, size}}, {}, options);
  return {std::move(mesh.positions), std::move(mesh.triangles), {}, {}};
}

FacetedMesh blob(int size, Interpolant interpolant = Interpolant::kPlane) {
  const double middle = size / 2.0 + 0.1;
  return contour_of(size, interpolant, [&](const Vector3& p) {
    const Vector3 d = p - Vector3{middle, middle - 0.2, middle};
    const double around = std::hypot(d[0], d[1]) - 0.28 * size;
    return std::hypot(around, d[2]) < 0.12 * size ||  // a ring and a rod through its hole
           (std::abs(d[2]) < 0.35 * size && std::max(std::abs(d[0]), std::abs(d[1])) < 0.07 * size);
  });
}

// A box of n x n quads per side, with vertex kinds and a label per side.
FacetedMesh box(int n, const Vector3& x, const Vector3& y, const Vector3& z) {
  FacetedMesh mesh;
  std::map<std::array<int, 3>, std::int32_t> numbers;
  const auto vertex = [&](const std::array<int, 3>& at) {
    const auto [found, is_new] =
        numbers.insert({at, static_cast<std::int32_t>(mesh.positions.size())});
    if (is_new) {
      mesh.positions.push_back(scaled(at[0], x) + scaled(at[1], y) + scaled(at[2], z));
      const auto ends = std::count_if(at.begin(), at.end(), [&](int i) { return i % n == 0; });
      mesh.kinds.push_back(static_cast<VertexKind>(ends - 1));
    }
    return found->second;
  };
  for (int side = 0; side < 6; ++side) {
    const int axis = side / 2;
    for (int i = 0; i < n * n; ++i) {
      std::array<std::int32_t, 4> quad;
      for (int k = 0; k < 4; ++k) {
        std::array<int, 3> at{};
        at[axis] = side % 2 * n;
        at[(axis + 1) % 3] = i / n + (k == 1 || k == 2 ? 1 : 0);
        at[(axis + 2) % 3] = i % n + (k >= 2 ? 1 : 0);
        quad[k] = vertex(at);
      }
      if (side % 2 == 0) std::swap(quad[1], quad[3]);
      mesh.triangles.push_back({quad[0], quad[1], quad[2]});
      mesh.triangles.push_back({quad[0], quad[2], quad[3]});
      mesh.labels.insert(mesh.labels.end(), 2, side);
    }
  }
  return mesh;
}

double area_of(const FacetedMesh& mesh) {
  double sum = 0.0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Vector3 a = corner(mesh, t, 0);
    sum += 0.5 * length(cross(corner(mesh, t, 1) - a, corner(mesh, t, 2) - a));
  }
  return sum;
}

std::map<std::int32_t, double> label_areas(const FacetedMesh& mesh) {
  std::map<std::int32_t, double> areas;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Vector3 a = corner(mesh, t, 0);
    areas[mesh.labels[t]] += 0.5 * length(cross(corner(mesh, t, 1) - a, corner(mesh, t, 2) - a));
  }
  return areas;
}

void expect_sound(const FacetedMesh& mesh) {
  EXPECT_EQ(fault_of(mesh), "");
  const MeshView<std::int32_t> view{mesh.positions, mesh.triangles};
  EXPECT_EQ(intersecting_triangles(view, {}, prefilter::Run(1)).size(), 0U);
}

TEST(Simplify, StaysWithinTheTolerance) {
  for (const Interpolant interpolant :
       {Interpolant::kPlane, Interpolant::kOccupancy, Interpolant::kLinear}) {
    const FacetedMesh before = blob(16, interpolant);
    for (const double tolerance : {0.02, 0.1, 0.3, 1.0}) {
      const FacetedMesh after = simplify(before, tolerance, prefilter::Run(1));
      expect_sound(after);
      EXPECT_LT(after.triangles.size(), before.triangles.size());
      EXPECT_LE(largest_distance(before, after, 2), tolerance);
      EXPECT_LE(largest_distance(after, before, 6), tolerance);
      EXPECT_NEAR(volume_of(after), volume_of(before), 0.5 * tolerance * area_of(before));
    }
  }
}

TEST(Simplify, StaysWithinTheToleranceOnRoughSurfaces) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> uniform(0.0F, 1.0F);
  constexpr int kSize = 9;
  for (int i = 0; i < 4; ++i) {
    std::vector<float> values(kSize * kSize * kSize);
    for (float& value : values) value = uniform(random);
    ContourOptions options;
    options.interpolant = i % 2 == 0 ? Interpolant::kLinear : Interpolant::kOccupancy;
    options.clean_up = false;
    TriangleMesh mesh = contour_grid({values.data(), {kSize, kSize, kSize}}, {}, options);
    const FacetedMesh before = {std::move(mesh.positions), std::move(mesh.triangles), {}, {}};
    for (const double tolerance : {0.03, 0.1, 0.4}) {
      const FacetedMesh after = simplify(before, tolerance, prefilter::Run(1));
      EXPECT_EQ(fault_of(after), "");
      EXPECT_LE(largest_distance(before, after, 3), tolerance);
      EXPECT_LE(largest_distance(after, before, 3), tolerance);
    }
  }
}

TEST(Simplify, LeavesFewTrianglesOnFlatParts) {
  const FacetedMesh before = blob(32);
  EXPECT_LT(simplify(before, 0.2, prefilter::Run(1)).triangles.size(), before.triangles.size() / 5);
}

TEST(Simplify, ReducesABoxToTwelveTriangles) {
  const std::array<std::array<Vector3, 3>, 2> frames = {
      {{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}},
       {{{0.36, 0.48, -0.8}, {-0.8, 0.6, 0.0}, {0.48, 0.64, 0.6}}}}};
  for (const auto& [x, y, z] : frames) {
    for (const int n : {1, 2, 7, 100}) {  // the last one is divided into patches
      const FacetedMesh before = box(n, x, y, z);
      ASSERT_EQ(fault_of(before), "");
      const FacetedMesh after = simplify(before, 0.01, prefilter::Run(2));
      expect_sound(after);
      EXPECT_EQ(after.triangles.size(), 12U) << n;
      EXPECT_NEAR(volume_of(after), n * n * n, 1e-9 * n * n * n);
      for (const VertexKind kind : after.kinds) EXPECT_EQ(kind, VertexKind::kCorner);
      for (const auto& [label, area] : label_areas(after)) EXPECT_NEAR(area, n * n, 1e-9 * n * n);
    }
  }
}

TEST(Simplify, KeepsTheBordersOfLabels) {
  // A flat side is divided into two labels along a line that bends; only the labels show it.
  constexpr int kSize = 40;
  FacetedMesh before = box(kSize, {1, 0, 0}, {0, 1, 0}, {0, 0, 1});
  before.kinds.clear();
  const auto is_second = [](const Vector3& p) {
    return p[1] < 12.0 || (p[0] > 21.0 && p[1] < 30.0);
  };
  for (std::size_t t = 0; t < before.triangles.size(); ++t) {
    Vector3 sum{};
    for (std::size_t i = 0; i < 3; ++i) sum = sum + corner(before, t, i);
    if (before.labels[t] == 4 && is_second(scaled(1.0 / 3.0, sum))) before.labels[t] = 6;
  }
  const FacetedMesh after = simplify(before, 0.05, prefilter::Run(1));
  expect_sound(after);
  EXPECT_LT(after.triangles.size(), 40U);
  const auto areas = label_areas(after);
  for (const auto& [label, area] : label_areas(before)) EXPECT_NEAR(areas.at(label), area, 1e-6);
}

TEST(Simplify, KeepsCreasesAlongCurves) {
  // A cylinder with labels for its side and ends, so that its rims are circles of equal length.
  constexpr double kRadius = 20.0;
  constexpr int kAround = 400;
  constexpr double kTolerance = 0.05;
  FacetedMesh before;
  for (int i = 0; i < kAround; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / kAround;
    for (const double z : {0.0, 30.0}) {
      before.positions.push_back({kRadius * std::cos(angle), kRadius * std::sin(angle), z});
    }
  }
  before.kinds.assign(before.positions.size(), VertexKind::kEdge);
  before.positions.push_back({0, 0, 0});
  before.positions.push_back({0, 0, 30});
  before.kinds.resize(before.positions.size(), VertexKind::kSurface);
  for (int i = 0; i < kAround; ++i) {
    const std::int32_t a = 2 * i;
    const std::int32_t b = 2 * ((i + 1) % kAround);
    for (const Triangle& t : {Triangle{a, b, a + 1}, {b, b + 1, a + 1}}) {
      before.triangles.push_back(t);
      before.labels.push_back(0);
    }
    before.triangles.push_back({b, a, 2 * kAround});
    before.labels.push_back(1);
    before.triangles.push_back({a + 1, b + 1, 2 * kAround + 1});
    before.labels.push_back(2);
  }
  ASSERT_EQ(fault_of(before), "");
  const FacetedMesh after = simplify(before, kTolerance, prefilter::Run(1));
  expect_sound(after);
  EXPECT_LT(after.triangles.size(), before.triangles.size() / 4);
  std::map<std::pair<std::int32_t, std::int32_t>, std::int32_t> labels;
  for (std::size_t t = 0; t < after.triangles.size(); ++t) {
    for (std::size_t i = 0; i < 3; ++i) {
      labels[{after.triangles[t][i], after.triangles[t][(i + 1) % 3]}] = after.labels[t];
    }
  }
  std::size_t count = 0;
  for (const auto& [edge, label] : labels) {
    if (label == labels.at({edge.second, edge.first})) continue;
    ++count;
    const Vector3 sum = after.positions[static_cast<std::size_t>(edge.first)] +
                        after.positions[static_cast<std::size_t>(edge.second)];
    EXPECT_NEAR(std::hypot(sum[0], sum[1]) / 2.0, kRadius, kTolerance);
    EXPECT_TRUE(sum[2] == 0.0 || sum[2] == 60.0);
  }
  EXPECT_GT(count, 20U);
}

TEST(Simplify, AddsNoIntersections) {
  // Two parallel sheets that are closer than the tolerance.
  const FacetedMesh before = contour_of(40, Interpolant::kPlane, [](const Vector3& p) {
    const double height = 20.0 + 5.0 * std::sin(0.3 * p[0]) * std::cos(0.25 * p[1]);
    const bool is_within = std::max(std::abs(p[0] - 20.0), std::abs(p[1] - 20.0)) < 17.0;
    return is_within && (std::abs(p[2] - height) < 1.5 || std::abs(p[2] - height - 4.2) < 1.2);
  });
  ASSERT_EQ(
      intersecting_triangles({before.positions, before.triangles}, {}, prefilter::Run(1)).size(),
      0U);
  for (const double tolerance : {0.5, 1.5, 4.0}) {
    expect_sound(simplify(before, tolerance, prefilter::Run(2)));
  }
}

TEST(Simplify, KeepsAClosedManifoldForAnyTolerance) {
  const FacetedMesh before = blob(24);
  for (const double tolerance : {1e-300, 1e-12, 10.0, 1e6, 1e300}) {
    const FacetedMesh after = simplify(before, tolerance, prefilter::Run(1));
    expect_sound(after);
    EXPECT_GE(after.triangles.size(), 4U);
  }
}

TEST(Simplify, IsScaleInvariant) {
  const FacetedMesh before = blob(20);
  const FacetedMesh expected = simplify(before, 0.25, prefilter::Run(1));
  for (const int exponent : {-60, 100}) {
    FacetedMesh moved = before;
    for (Vector3& p : moved.positions) p = scaled(std::ldexp(1.0, exponent), p);
    EXPECT_EQ(simplify(moved, std::ldexp(0.25, exponent), prefilter::Run(1)).triangles,
              expected.triangles);
  }
}

TEST(Simplify, IsTheSameForAnyNumberOfThreads) {
  const FacetedMesh before = blob(72);
  ASSERT_GT(before.triangles.size(), 20000U);  // several patches
  const FacetedMesh one = simplify(before, 0.1, prefilter::Run(1));
  expect_sound(one);
  const FacetedMesh other = simplify(before, 0.1, prefilter::Run(3));
  EXPECT_EQ(one.positions, other.positions);
  EXPECT_EQ(one.triangles, other.triangles);
}

TEST(Simplify, KeepsMinimalMeshes) {
  EXPECT_TRUE(simplify({}, 1.0, prefilter::Run(1)).triangles.empty());
  FacetedMesh tetrahedron;
  tetrahedron.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  tetrahedron.triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
  EXPECT_EQ(simplify(tetrahedron, 1e9, prefilter::Run(1)).triangles, tetrahedron.triangles);
  const FacetedMesh before = blob(16);
  const FacetedMesh same = simplify(before, 0.0, prefilter::Run(1));
  EXPECT_EQ(same.positions, before.positions);
  EXPECT_EQ(same.triangles, before.triangles);
}

TEST(Simplify, RefusesInvalidTolerances) {
  for (const double tolerance : {-1.0, std::nan(""), std::numeric_limits<double>::infinity()}) {
    EXPECT_THROW(simplify(blob(8), tolerance, prefilter::Run(1)), Error);
  }
}

TEST(Simplify, StopsWhenAsked) {
  const FacetedMesh before = blob(40);
  int calls = 0;
  const prefilter::Run run([&](double) { return ++calls < 2; });
  EXPECT_THROW(simplify(before, 0.1, run.with_threads(2)), Error);
}

}  // namespace
}  // namespace prefilter
