// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/base/radix_sort.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <utility>

namespace prefilter {
namespace {

TEST(RadixSort, SortsByTheBitsAndKeepsTheOrderOfEqualOnes) {
  std::mt19937_64 random(1);
  for (const std::size_t count :
       {std::size_t{0}, std::size_t{1}, std::size_t{2}, std::size_t{5000}}) {
    for (const auto& [low, high] :
         {std::pair{0, 64}, {17, 56}, {0, 1}, {63, 64}, {5, 16}, {5, 17}, {9, 9}}) {
      std::vector<std::uint64_t> values(count);
      // Few different digits, so that many are equal.
      for (std::uint64_t& value : values) value = random() & random() & random();
      const auto digits = [first = low, end = high](std::uint64_t value) {
        return end == first ? 0 : value << (64 - end) >> (64 - end + first);
      };
      std::vector<std::uint64_t> wanted = values;
      std::stable_sort(wanted.begin(), wanted.end(),
                       [&](std::uint64_t a, std::uint64_t b) { return digits(a) < digits(b); });
      std::vector<std::uint64_t> other(3, 7);
      radix_sort(&values, low, high, &other);
      ASSERT_EQ(values, wanted) << count << " " << low << " " << high;
    }
  }
}

}  // namespace
}  // namespace prefilter
