// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/spatial/winding_numbers.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <random>

#include "prefilter/base/error.h"
#include "wavelet/meshes.h"

namespace prefilter {
namespace {

using Triangles = std::vector<std::array<std::int64_t, 3>>;

Triangles triangles_of(const testing::Mesh& mesh) {
  Triangles triangles;
  for (const auto& t : mesh.triangles) triangles.push_back({t[0], t[1], t[2]});
  return triangles;
}

TEST(WindingNumbers, OfASphere) {
  const testing::Mesh mesh = testing::sphere_mesh({0.5, 0.5, 0.5}, 0.4, 60);
  const Triangles triangles = triangles_of(mesh);
  const WindingNumbers winding({mesh.positions, triangles}, Progress(), 2);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  for (int i = 0; i < 500; ++i) {
    const Vector3 point = {uniform(random), uniform(random), uniform(random)};
    const double distance = length(point - Vector3{0.5, 0.5, 0.5});
    if (std::abs(distance - 0.4) < 0.002) continue;
    EXPECT_NEAR(winding.at(point), distance < 0.4 ? 1.0 : 0.0, 0.02);
  }
}

TEST(WindingNumbers, OfAnOpenBox) {
  // One of six sides is missing: from the middle, a sixth of all directions.
  const testing::Mesh mesh = testing::box_mesh({0, 0, 0}, {1, 1, 1});
  Triangles triangles = triangles_of(mesh);
  triangles.resize(10);
  const WindingNumbers winding({mesh.positions, triangles}, Progress(), 1);
  EXPECT_NEAR(winding.at({0.5, 0.5, 0.5}), 5.0 / 6.0, 1e-12);
  // In the middle of the missing side all that is missing is in the point's plane.
  EXPECT_NEAR(winding.at({1.0, 0.5, 0.5}), 0.5, 1e-12);
  // On the side across: the mean of both its sides, less the solid angle of a square from its
  // distance.
  const double missing = 4.0 * std::atan(0.25 / std::sqrt(1.5)) / (4.0 * std::acos(-1.0));
  EXPECT_NEAR(winding.at({0.0, 0.5, 0.5}), 0.5 - missing, 1e-12);
}

TEST(WindingNumbers, ThreadsAndErrors) {
  const testing::Mesh mesh = testing::sphere_mesh({0.5, 0.5, 0.5}, 0.4, 20);
  const Triangles triangles = triangles_of(mesh);
  const WindingNumbers winding({mesh.positions, triangles}, Progress(), 1);
  const std::vector<Vector3> points(3000, Vector3{0.3, 0.4, 0.5});
  EXPECT_EQ(winding.find(points, Progress(), 1), winding.find(points, Progress(), 3));
  const std::vector<Vector3> bad = {{0.0, std::numeric_limits<double>::quiet_NaN(), 0.0}};
  EXPECT_THROW(winding.find(bad, Progress(), 1), Error);
}

}  // namespace
}  // namespace prefilter
