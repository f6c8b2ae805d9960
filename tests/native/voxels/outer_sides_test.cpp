// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/voxels/outer_sides.h"

#include <gtest/gtest.h>

#include <random>

#include "wavelet/meshes.h"

namespace prefilter {
namespace {

// Nested balls, with winding numbers known from the distances to their centers.
TEST(OuterSides, WindingNumbersMatchNestedBalls) {
  struct Ball {
    Vector3 middle;
    double radius;
  };
  const std::array<Ball, 3> balls = {
      {{{8.0, 8.0, 8.0}, 6.0}, {{9.0, 8.0, 8.0}, 3.0}, {{14.0, 9.0, 8.0}, 4.0}}};
  std::vector<Vector3> positions;
  std::vector<std::array<std::int64_t, 3>> triangles;
  for (const Ball& ball : balls) {
    const testing::Mesh mesh = testing::sphere_mesh(ball.middle, ball.radius, 60);
    const auto first = static_cast<std::int64_t>(positions.size());
    positions.insert(positions.end(), mesh.positions.begin(), mesh.positions.end());
    for (const auto& t : mesh.triangles) {
      triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
    }
  }
  const WindingNumbers winding({positions, triangles}, prefilter::Run(2));
  const std::function<float(const Vector3&)> mixed = [](const Vector3&) { return 0.5F; };
  const OuterSides sides(mixed, winding);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform(0.0, 20.0);
  for (int i = 0; i < 3000; ++i) {
    const Vector3 point = {uniform(random), uniform(random), uniform(random)};
    double expected = 0.0;
    bool is_near = false;
    for (const Ball& ball : balls) {
      const double distance = length(point - ball.middle);
      is_near = is_near || std::abs(distance - ball.radius) < 0.05;
      if (distance < ball.radius) expected += 1.0;
    }
    if (is_near) continue;
    EXPECT_NEAR(sides.winding_at(point), expected, 0.2);
    // Where no cell decides, the winding number does.
    EXPECT_EQ(sides.is_outer(point, {0.0, 0.0, 1.0}), expected < 0.5);
  }
}

}  // namespace
}  // namespace prefilter
