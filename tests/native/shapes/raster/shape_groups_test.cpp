// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/shapes/raster/shape_groups.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

namespace prefilter {
namespace {

bool meet(const Box2& a, const Box2& b) {
  return a.low.x <= b.high.x && b.low.x <= a.high.x && a.low.y <= b.high.y && b.low.y <= a.high.y;
}

TEST(ShapeGroups, ContainAllOverlappingBoxes) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  for (const double size : {0.005, 0.02, 0.06, 0.5}) {
    std::vector<Box2> boxes(400);
    for (Box2& box : boxes) {
      const Point2 low{unit(random), unit(random)};
      box = {low, low + Point2{size * unit(random), size * unit(random)}};
    }
    boxes[17] = {};
    const auto groups = overlapping_groups(boxes);
    std::vector<int> group_of(boxes.size(), -1);
    for (std::size_t g = 0; g < groups.size(); ++g) {
      EXPECT_TRUE(std::is_sorted(groups[g].begin(), groups[g].end()));
      for (const std::uint32_t i : groups[g]) {
        EXPECT_EQ(group_of[i], -1);
        group_of[i] = static_cast<int>(g);
      }
    }
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      EXPECT_EQ(group_of[i] == -1, i == 17);
      for (std::size_t j = 0; j < i; ++j) {
        EXPECT_TRUE(!meet(boxes[i], boxes[j]) || group_of[i] == group_of[j]);
      }
    }
  }
}

// On a sparse grid each box is its own group; on one where neighbors touch all are one group.
TEST(ShapeGroups, SeparateBoxesAreAlone) {
  for (const double side : {0.9, 1.0}) {
    std::vector<Box2> boxes;
    for (int i = 0; i < 400; ++i) {
      const int place = i * 7 % 400;
      const Point2 low{static_cast<double>(place % 20), static_cast<double>(place / 20)};
      boxes.push_back({low, low + Point2{side, side}});
    }
    EXPECT_EQ(overlapping_groups(boxes).size(), side < 1.0 ? 400U : 1U);
  }
  EXPECT_TRUE(overlapping_groups({}).empty());
}

}  // namespace
}  // namespace prefilter
