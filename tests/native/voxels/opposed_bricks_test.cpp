// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/voxels/opposed_bricks.h"

#include <gtest/gtest.h>

#include <vector>

namespace prefilter {
namespace {

using Triangle = std::array<std::int32_t, 3>;

// Grids of 8 x 8 unit squares at these heights; every second one faces down.
struct Sheets {
  std::vector<Vector3> positions;
  std::vector<Triangle> triangles;
  std::vector<Vector3> normals;

  explicit Sheets(const std::vector<double>& heights) {
    bool is_down = true;
    for (const double z : heights) {
      const auto first = static_cast<std::int32_t>(positions.size());
      for (const auto& [x, y] : {std::pair{0.0, 0.0}, {8.0, 0.0}, {8.0, 8.0}, {0.0, 8.0}}) {
        positions.push_back({x, y, z});
      }
      for (const int k : {1, 2}) {
        triangles.push_back({first, first + k, first + k + 1});
        if (is_down) std::swap(triangles.back()[1], triangles.back()[2]);
        normals.push_back({0.0, 0.0, is_down ? -1.0 : 1.0});
      }
      is_down = !is_down;
    }
  }

  OpposedBricks bricks() const {
    const Box bounds = {{-10.0, -10.0, -10.0}, {20.0, 20.0, 20.0}};
    return OpposedBricks({positions, triangles}, normals, 2.0, bounds, prefilter::Run(2));
  }
};

TEST(OpposedBricks, AreFoundBetweenOpposedFaces) {
  const OpposedBricks thin = Sheets({0.5, 1.0}).bricks();
  EXPECT_TRUE(thin.holds({3.0, 3.0, 0.5}));
  EXPECT_FALSE(thin.holds({3.0, 3.0, 6.5}));
  EXPECT_TRUE(Sheets({0.5, 9.0}).bricks().is_empty());
  // Neighboring bricks in every direction.
  const OpposedBricks beside = Sheets({1.9, 2.1}).bricks();
  EXPECT_TRUE(beside.holds({3.0, 3.0, 1.9}));
  EXPECT_TRUE(beside.holds({7.9, 0.1, 2.1}));
}

TEST(OpposedBricks, AreCrowdedForCoincidentFaces) {
  std::vector<double> heights;
  for (int i = 0; i < 20; ++i) heights.push_back(0.05 + 0.095 * i);
  EXPECT_TRUE(Sheets(heights).bricks().is_crowded({3.0, 3.0, 1.0}));
  EXPECT_FALSE(Sheets({0.5, 1.0, 1.5, 1.9}).bricks().is_crowded({3.0, 3.0, 1.0}));
}

}  // namespace
}  // namespace prefilter
