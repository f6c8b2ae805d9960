// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/wavelet/triangle_analysis.h"

#include <gtest/gtest.h>

#include <random>

#include "prefilter/base/error.h"
#include "prefilter/voxels/queries.h"
#include "wavelet/meshes.h"

namespace prefilter {
namespace {

using testing::box_mesh;
using testing::covered;
using testing::Mesh;
using testing::sphere_mesh;

std::vector<float> occupancies(const Mesh& mesh, int depth, int shown_depth = -1, int threads = 1) {
  HaarTree coefficients = analyze_triangles(mesh.view(), depth, prefilter::Run(threads));
  Octree octree{synthesise(std::move(coefficients), shown_depth, prefilter::Run(threads)),
                {{0.0, 0.0, 0.0}, {1.0, 1.0, 1.0}},
                depth,
                {}};
  return dense_values(octree, shown_depth < 0 ? depth : shown_depth, prefilter::Run(1));
}

// The largest difference from a box's occupancies in closed form.
double box_error(const std::vector<float>& found, const Vector3& low, const Vector3& high, int n) {
  double worst = 0.0;
  std::size_t i = 0;
  for (int x = 0; x < n; ++x) {
    for (int y = 0; y < n; ++y) {
      for (int z = 0; z < n; ++z, ++i) {
        const double exact = covered(low[0], high[0], x, n) * covered(low[1], high[1], y, n) *
                             covered(low[2], high[2], z, n);
        worst = std::max(worst, std::abs(found[i] - exact));
      }
    }
  }
  return worst;
}

TEST(TriangleAnalysis, BoxesHaveTheirOccupancyAtEveryDepth) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  for (int trial = 0; trial < 20; ++trial) {
    Vector3 low;
    Vector3 high;
    for (int a = 0; a < 3; ++a) {
      low[a] = 0.5 * uniform(random);
      high[a] = low[a] + 0.01 + 0.48 * uniform(random);
    }
    const Mesh mesh = box_mesh(low, high);
    for (int depth = 1; depth <= 6; ++depth) {
      EXPECT_LT(box_error(occupancies(mesh, depth), low, high, 1 << depth), 1e-6);
    }
  }
}

TEST(TriangleAnalysis, FewerCoefficientsGiveTheMeans) {
  const Vector3 low = {0.11, 0.23, 0.31};
  const Vector3 high = {0.71, 0.57, 0.97};
  for (int shown = 1; shown < 6; ++shown) {
    EXPECT_LT(box_error(occupancies(box_mesh(low, high), 6, shown), low, high, 1 << shown), 1e-6);
  }
}

TEST(TriangleAnalysis, FacesOnTheGridAreExact) {
  const Vector3 low = {0.25, 0.0, 0.5};
  const Vector3 high = {0.75, 1.0, 0.625};
  EXPECT_LT(box_error(occupancies(box_mesh(low, high), 5), low, high, 32), 1e-6);
}

TEST(TriangleAnalysis, TrianglesAreClippedToTheRoot) {
  const Vector3 low = {-0.4, 0.3, -3.0};
  const Vector3 high = {0.6, 7.0, 0.4};
  EXPECT_LT(box_error(occupancies(box_mesh(low, high), 5), low, high, 32), 1e-6);
  const Vector3 around_low = {-1.0, -2.0, -1.5};
  const Vector3 around_high = {2.0, 3.0, 1.5};
  EXPECT_EQ(
      box_error(occupancies(box_mesh(around_low, around_high), 3), around_low, around_high, 8),
      0.0);
  const Vector3 beside_low = {1.5, 0.1, 0.1};
  const Vector3 beside_high = {1.8, 0.9, 0.9};
  EXPECT_EQ(
      box_error(occupancies(box_mesh(beside_low, beside_high), 3), beside_low, beside_high, 8),
      0.0);
}

TEST(TriangleAnalysis, CavitiesAreEmptyAndOverlapsCountOnce) {
  const Vector3 low = {0.1, 0.1, 0.1};
  const Vector3 high = {0.9, 0.9, 0.9};
  Mesh hollow = box_mesh(low, high);
  Mesh cavity = box_mesh({0.3, 0.35, 0.4}, {0.55, 0.6, 0.65});
  for (auto& triangle : cavity.triangles) std::swap(triangle[0], triangle[1]);
  hollow.add(cavity);
  const int n = 32;
  const std::vector<float> found = occupancies(hollow, 5);
  double worst = 0.0;
  std::size_t i = 0;
  for (int x = 0; x < n; ++x) {
    for (int y = 0; y < n; ++y) {
      for (int z = 0; z < n; ++z, ++i) {
        const double outer =
            covered(0.1, 0.9, x, n) * covered(0.1, 0.9, y, n) * covered(0.1, 0.9, z, n);
        const double inner =
            covered(0.3, 0.55, x, n) * covered(0.35, 0.6, y, n) * covered(0.4, 0.65, z, n);
        worst = std::max(worst, std::abs(found[i] - (outer - inner)));
      }
    }
  }
  EXPECT_LT(worst, 1e-6);

  Mesh twice = box_mesh(low, high);
  twice.add(box_mesh({0.25, 0.25, 0.25}, {0.5, 0.5, 0.5}));
  EXPECT_LT(box_error(occupancies(twice, 5), low, high, n), 1e-6);
}

TEST(TriangleAnalysis, ThreadsDoNotChangeTheResult) {
  const Mesh mesh = sphere_mesh({0.5, 0.45, 0.52}, 0.4, 150);
  const std::vector<float> one = occupancies(mesh, 7, -1, 1);
  EXPECT_EQ(one, occupancies(mesh, 7, -1, 2));
  EXPECT_EQ(one, occupancies(mesh, 7, -1, 5));
}

TEST(TriangleAnalysis, AMissingFaceLeavesTheMeanOfTheRoot) {
  const Vector3 low = {0.2, 0.3, 0.25};
  const Vector3 high = {0.8, 0.9, 0.65};
  const double volume = 0.6 * 0.6 * 0.4;
  for (std::size_t face = 0; face < 6; ++face) {
    Mesh mesh = box_mesh(low, high);
    const auto first = mesh.triangles.begin() + static_cast<std::ptrdiff_t>(2 * face);
    mesh.triangles.erase(first, first + 2);
    EXPECT_NEAR(analyze_triangles(mesh.view(), 5, prefilter::Run(1)).mean, volume, 1e-12) << face;
  }
}

TEST(TriangleAnalysis, FarFromAHoleLittleChanges) {
  const Mesh closed = sphere_mesh({0.5, 0.5, 0.5}, 0.4, 60);
  Mesh open = closed;
  const std::array<std::int32_t, 3> gone = open.triangles[1000];
  open.triangles.erase(open.triangles.begin() + 1000);
  const auto& a = closed.positions[static_cast<std::size_t>(gone[0])];
  const auto& b = closed.positions[static_cast<std::size_t>(gone[1])];
  const auto& c = closed.positions[static_cast<std::size_t>(gone[2])];
  Vector3 u;
  Vector3 v;
  for (int i = 0; i < 3; ++i) {
    u[i] = b[i] - a[i];
    v[i] = c[i] - a[i];
  }
  const double area =
      std::hypot(u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]) /
      2.0;
  const int depth = 6;
  const int n = 1 << depth;
  const std::vector<float> before = occupancies(closed, depth);
  const std::vector<float> after = occupancies(open, depth);
  std::size_t index = 0;
  double least_bound = 1e9;
  for (int x = 0; x < n; ++x) {
    for (int y = 0; y < n; ++y) {
      for (int z = 0; z < n; ++z, ++index) {
        // Over all cells that contain both this one and a part of the hole's box.
        double bound = area;  // for the root's mean
        for (int k = 0; k < depth; ++k) {
          const double side = std::ldexp(1.0, -k);
          bool holds = true;
          const std::array<int, 3> cell = {x, y, z};
          for (int i = 0; i < 3; ++i) {
            const double low = std::floor(cell[i] / (n * side)) * side;
            holds = holds && std::max({a[i], b[i], c[i]}) >= low &&
                    std::min({a[i], b[i], c[i]}) <= low + side;
          }
          if (holds) bound += 2.03 * area / (side * side);
        }
        least_bound = std::min(least_bound, bound);
        ASSERT_LE(std::abs(after[index] - before[index]), bound + 2e-5);
      }
    }
  }
  EXPECT_LT(least_bound, 0.01);
}

TEST(TriangleAnalysis, CanBeStopped) {
  const Mesh mesh = sphere_mesh({0.5, 0.5, 0.5}, 0.4, 200);
  const prefilter::Run stop([](double) { return false; });
  EXPECT_THROW(analyze_triangles(mesh.view(), 8, stop.with_threads(2)), Error);
}

}  // namespace
}  // namespace prefilter
