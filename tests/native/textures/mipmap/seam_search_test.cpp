// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/textures/mipmap/seam_search.h"

#include <gtest/gtest.h>

#include <cmath>

namespace prefilter {
namespace {

// If the root rises by a share s, its square rises by (1 + s)^2 - 1.
TEST(SeamSearch, BudgetIsRelativeToTheRoot) {
  for (const double share : {0.01, 0.5, 3.0}) {
    const double root = std::sqrt(7.0) * (1.0 + share);
    EXPECT_NEAR(allowed_rise({.share = share}, 7.0, 0.0), root * root - 7.0, 1e-12);
  }
  EXPECT_LT(allowed_rise({.share = 0.5}, 1e-9, 1.0), 0.0);  // such an error is rounding only
}

// The spent share is a power of the weight, with an exponent unknown to the search.
TEST(SeamSearch, EndsCloseBelowTheBudgetOrAroundIt) {
  for (const double power : {0.6, 0.8, 1.4, 2.0}) {
    for (const double right : {1e-3, 0.1, 1.0, 20.0}) {
      for (const double first : {1e-4, 1.0, 60.0}) {
        WeightSearch search(first);
        int tries = 0;
        double below = 0.0;
        double above = HUGE_VAL;
        while (!search.done()) {
          ASSERT_LE(search.weight(), WeightSearch::kMaxWeight);
          const double spent = std::pow(search.weight() / right, power);
          (spent <= 1.0 ? below : above) = search.weight();
          search.report(spent);
          EXPECT_EQ(search.is_over(), spent > 1.0);
          ++tries;
        }
        EXPECT_LE(tries, 8);
        const bool is_close = std::pow(below / right, power) >= WeightSearch::kCloseEnough;
        const bool is_around = below > 0.0 && above <= 2.0 * below;
        EXPECT_TRUE(is_close || is_around) << power << ", " << right << ", " << first;
      }
    }
  }
}

TEST(SeamSearch, StopsAtTheMaximumWeight) {
  WeightSearch search(1.0);
  int tries = 0;
  while (!search.done()) {
    search.report(1e-6 * search.weight());
    ++tries;
  }
  EXPECT_FALSE(search.is_over());
  EXPECT_EQ(search.weight(), WeightSearch::kMaxWeight);
  EXPECT_LE(tries, 4);
}

}  // namespace
}  // namespace prefilter
