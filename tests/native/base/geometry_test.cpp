// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/base/geometry.h"

#include <gtest/gtest.h>

#include "prefilter/base/error.h"

namespace prefilter {
namespace {

TEST(Box, GrowsFromNothing) {
  Box box = kEmptyBox;
  box.include(Vector3{1.0, 2.0, 3.0});
  box.include(Vector3{-1.0, 5.0, 3.0});
  EXPECT_EQ(box.low, (Vector3{-1.0, 2.0, 3.0}));
  EXPECT_EQ(box.high, (Vector3{1.0, 5.0, 3.0}));
  EXPECT_EQ(box.squared_distance({0.0, 3.0, 3.0}), 0.0);
  EXPECT_EQ(box.squared_distance({3.0, 1.0, 5.0}), 4.0 + 1.0 + 4.0);
  EXPECT_THROW(check_box(box, "box"), Error);  // flat
}

TEST(Vector3, ProductsAreThoseOfTheAxes) {
  const Vector3 x = {1.0, 0.0, 0.0};
  const Vector3 y = {0.0, 2.0, 0.0};
  EXPECT_EQ(cross(x, y), (Vector3{0.0, 0.0, 2.0}));
  EXPECT_EQ(dot(x + y, y - x), 3.0);
  EXPECT_DOUBLE_EQ(length({3e200, 0.0, 4e200}), 5e200);
}

}  // namespace
}  // namespace prefilter
