// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/base/sort.h"

#include <gtest/gtest.h>

#include <random>

#include "prefilter/base/error.h"

namespace prefilter {
namespace {

TEST(SortInParallel, SortsAsTheStandardLibraryDoes) {
  std::mt19937 random(1);
  for (const std::size_t count : {std::size_t{0}, std::size_t{1}, std::size_t{32768},
                                  std::size_t{32769}, std::size_t{300001}}) {
    for (const unsigned different : {2U, 1000U, 4000000000U}) {
      std::vector<std::uint32_t> values(count);
      for (std::uint32_t& value : values) value = static_cast<std::uint32_t>(random() % different);
      std::vector<std::uint32_t> wanted = values;
      std::sort(wanted.begin(), wanted.end(), std::greater<>());
      sort_in_parallel(&values, prefilter::Run(3), std::greater<>());
      ASSERT_EQ(values, wanted) << count << " " << different;
    }
  }
}

TEST(SortInParallel, CanBeStopped) {
  std::vector<int> values(200000, 1);
  const prefilter::Run stop([](double) { return false; });
  EXPECT_THROW(sort_in_parallel(&values, stop.with_threads(2)), Error);
}

}  // namespace
}  // namespace prefilter
