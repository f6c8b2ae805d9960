// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/shapes/set_operations.h"

#include <gtest/gtest.h>

#include <limits>

#include "prefilter/base/error.h"
#include "shapes/outline/outline_oracle.h"

namespace prefilter {
namespace {

using namespace outline_oracle;

constexpr FillRule kRule = FillRule::kNonzero;

Outline square(double side) {
  Outline outline;
  outline.move_to({0.0, 0.0});
  outline.line_to({side, 0.0});
  outline.line_to({side, side});
  outline.line_to({0.0, side});
  outline.close();
  return outline;
}

double left_of(const Outline& first, const Outline& second, OutlineOperation operation) {
  return area(fine_chains(combine(first, kRule, second, kRule, operation), 1));
}

TEST(Combine, HasTheAreasOfSets) {
  const Outline first = square(3.0);
  const Outline second = square(2.0).transformed({{1, 0}, {0, 1}, {2.0, 2.0}});
  EXPECT_NEAR(left_of(first, second, OutlineOperation::kUnion), 12.0, 1e-9);
  EXPECT_NEAR(left_of(first, second, OutlineOperation::kIntersection), 1.0, 1e-9);
  EXPECT_NEAR(left_of(first, second, OutlineOperation::kDifference), 8.0, 1e-9);
}

TEST(Combine, RefusesPointsWhoseDifferencesAreNotFinite) {
  const Outline plain = square(1.0);
  for (const double far : {1e101, -1e308, std::numeric_limits<double>::infinity(),
                           std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_THROW(combine(square(far), kRule, plain, kRule, OutlineOperation::kUnion), Error);
    EXPECT_THROW(combine(plain, kRule, square(far), kRule, OutlineOperation::kUnion), Error);
  }
  EXPECT_NO_THROW(combine(square(1e99), kRule, plain, kRule, OutlineOperation::kUnion));
}

}  // namespace
}  // namespace prefilter
