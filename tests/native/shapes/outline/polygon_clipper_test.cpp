// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/shapes/outline/polygon_clipper.h"

#include <gtest/gtest.h>

#include <numbers>

#include "shapes/outline/outline_oracle.h"

namespace prefilter {
namespace {

using namespace outline_oracle;

TEST(PolygonClipper, FlattensWithinTheTolerance) {
  const Outline disc = circle({3, 4}, 100.0);
  double last = HUGE_VAL;
  for (const double tolerance : {1.0, 1e-2, 1e-4}) {
    const std::vector<Polygon> polygons = flattened(disc, tolerance);
    ASSERT_EQ(polygons.size(), 1u);
    double largest = 0.0;
    for (std::size_t i = 0; i < polygons[0].size(); ++i) {
      const Point2& next = polygons[0][(i + 1) % polygons[0].size()];
      const Point2 middle = 0.5 * (polygons[0][i] + next) - Point2{3, 4};
      largest = std::max(largest, 100.0 - std::hypot(middle.x, middle.y));
    }
    EXPECT_LE(largest, tolerance);
    EXPECT_LT(largest, last);
    last = largest;
  }
}

TEST(PolygonClipper, CombinesByEitherRule) {
  const std::vector<Polygon> twice = {{{0, 0}, {4, 0}, {4, 4}, {0, 4}},
                                      {{1, 1}, {3, 1}, {3, 3}, {1, 3}}};
  const std::vector<Polygon> other = {{{2, 0}, {6, 0}, {6, 4}, {2, 4}}};
  const auto area_of = [&](FillRule rule, OutlineOperation operation) {
    return area(combine_polygons(twice, rule, other, FillRule::kNonzero, operation));
  };
  EXPECT_NEAR(area_of(FillRule::kNonzero, OutlineOperation::kUnion), 24.0, 1e-9);
  EXPECT_NEAR(area_of(FillRule::kNonzero, OutlineOperation::kIntersection), 8.0, 1e-9);
  EXPECT_NEAR(area_of(FillRule::kNonzero, OutlineOperation::kDifference), 8.0, 1e-9);
  EXPECT_NEAR(area_of(FillRule::kEvenOdd, OutlineOperation::kUnion), 22.0, 1e-9);
  EXPECT_NEAR(area_of(FillRule::kEvenOdd, OutlineOperation::kIntersection), 6.0, 1e-9);
  EXPECT_NEAR(area_of(FillRule::kEvenOdd, OutlineOperation::kDifference), 6.0, 1e-9);
}

}  // namespace
}  // namespace prefilter
