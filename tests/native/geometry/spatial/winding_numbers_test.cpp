// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/geometry/spatial/winding_numbers.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <optional>
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
  const WindingNumbers winding({mesh.positions, triangles}, prefilter::Run(2));
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  for (int i = 0; i < 500; ++i) {
    const Vector3 point = {uniform(random), uniform(random), uniform(random)};
    const double distance = length(point - Vector3{0.5, 0.5, 0.5});
    if (std::abs(distance - 0.4) < 0.002) continue;
    EXPECT_NEAR(winding.at(point), distance < 0.4 ? 1.0 : 0.0, 0.02);
  }
}

// Along any segment the number changes by the signed number of crossings.
TEST(WindingNumbers, ExcessIsTheDifference) {
  testing::Mesh mesh = testing::sphere_mesh({0.5, 0.5, 0.5}, 0.4, 60);
  const testing::Mesh other = testing::sphere_mesh({0.6, 0.5, 0.5}, 0.3, 40);
  Triangles triangles = triangles_of(mesh);
  const auto first = static_cast<std::int64_t>(mesh.positions.size());
  for (const auto& t : triangles_of(other)) {
    triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  }
  mesh.positions.insert(mesh.positions.end(), other.positions.begin(), other.positions.end());
  const WindingNumbers winding({mesh.positions, triangles}, prefilter::Run(2));
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  int sure = 0;
  std::array<int, 5> counts{};
  for (int i = 0; i < 500; ++i) {
    const Vector3 from = {uniform(random), uniform(random), uniform(random)};
    const Vector3 to = {uniform(random), uniform(random), uniform(random)};
    const std::optional<double> excess = winding.excess(from, to);
    if (!excess) continue;
    ++sure;
    EXPECT_NEAR(*excess, winding.at(from) - winding.at(to), 0.05);
    EXPECT_NEAR(winding.at(from, 2.0), winding.at(from), 0.1);
    ++counts.at(static_cast<std::size_t>(*excess + 2.0));
  }
  EXPECT_GT(sure, 490);
  for (const int count : counts) EXPECT_GT(count, 0);
  const Vector3 corner = mesh.positions[0];
  const Vector3 middle = {0.5, 0.5, 0.5};
  EXPECT_FALSE(winding.excess(middle, 2.0 * corner - middle).has_value());
}

TEST(WindingNumbers, OfAnOpenBox) {
  // One of six sides is missing: seen from the center, a sixth of the sphere.
  const testing::Mesh mesh = testing::box_mesh({0, 0, 0}, {1, 1, 1});
  Triangles triangles = triangles_of(mesh);
  triangles.resize(10);
  const WindingNumbers winding({mesh.positions, triangles}, prefilter::Run(1));
  EXPECT_NEAR(winding.at({0.5, 0.5, 0.5}), 5.0 / 6.0, 1e-12);
  // At the center of the missing side, it lies in the point's plane.
  EXPECT_NEAR(winding.at({1.0, 0.5, 0.5}), 0.5, 1e-12);
  // On the opposite side: the mean of both its sides, minus the solid angle of the missing square.
  const double missing = 4.0 * std::atan(0.25 / std::sqrt(1.5)) / (4.0 * std::acos(-1.0));
  EXPECT_NEAR(winding.at({0.0, 0.5, 0.5}), 0.5 - missing, 1e-12);
}

// The formula of van Oosterom and Strackee, summed over all triangles.
double sum_of_solid_angles(const testing::Mesh& mesh, const Triangles& triangles,
                           const Vector3& point) {
  double sum = 0.0;
  for (const auto& [i, j, k] : triangles) {
    const Vector3 a = mesh.positions[static_cast<std::size_t>(i)] - point;
    const Vector3 b = mesh.positions[static_cast<std::size_t>(j)] - point;
    const Vector3 c = mesh.positions[static_cast<std::size_t>(k)] - point;
    const double la = length(a);
    const double lb = length(b);
    const double lc = length(c);
    sum += 2.0 * std::atan2(dot(a, cross(b, c)),
                            la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb);
  }
  return sum / (4.0 * std::acos(-1.0));
}

TEST(WindingNumbers, OpenMeshesAreTheSumOfSolidAngles) {
  testing::Mesh mesh = testing::sphere_mesh({0.5, 0.5, 0.5}, 0.4, 40);
  std::mt19937 random(2);
  std::uniform_real_distribution<double> uniform(-0.5, 1.5);
  for (Vector3& p : mesh.positions) p[2] *= p[0] < 0.5 ? 0.3 : 1.0;  // no longer round
  Triangles triangles = triangles_of(mesh);
  triangles.resize(triangles.size() / 3);
  const WindingNumbers winding({mesh.positions, triangles}, prefilter::Run(1));
  for (int i = 0; i < 300; ++i) {
    const Vector3 point = {uniform(random), uniform(random), uniform(random)};
    EXPECT_NEAR(winding.at(point), sum_of_solid_angles(mesh, triangles, point), 0.01);
  }
}

TEST(WindingNumbers, ThreadsAndErrors) {
  const testing::Mesh mesh = testing::sphere_mesh({0.5, 0.5, 0.5}, 0.4, 20);
  const Triangles triangles = triangles_of(mesh);
  const WindingNumbers winding({mesh.positions, triangles}, prefilter::Run(1));
  const std::vector<Vector3> points(3000, Vector3{0.3, 0.4, 0.5});
  EXPECT_EQ(winding.find(points, prefilter::Run(1)), winding.find(points, prefilter::Run(3)));
  const std::vector<Vector3> bad = {{0.0, std::numeric_limits<double>::quiet_NaN(), 0.0}};
  EXPECT_THROW(winding.find(bad, prefilter::Run(1)), Error);
}

}  // namespace
}  // namespace prefilter
