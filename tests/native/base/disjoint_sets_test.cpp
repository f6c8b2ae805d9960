// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/base/disjoint_sets.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <random>
#include <thread>
#include <utility>
#include <vector>

namespace prefilter {
namespace {

using Sets = DisjointSets<std::int32_t>;
using Pairs = std::vector<std::pair<std::int32_t, std::int32_t>>;

Pairs random_pairs(std::int32_t members, std::size_t count) {
  std::mt19937 random(7);
  std::uniform_int_distribution<std::int32_t> any(0, members - 1);
  Pairs pairs(count);
  for (auto& [a, b] : pairs) {
    a = any(random);
    b = any(random);
  }
  return pairs;
}

// The lowest number that each can reach, by propagating it until nothing changes.
std::vector<std::int32_t> lowest_reached(std::int32_t members, const Pairs& pairs) {
  std::vector<std::int32_t> lowest(static_cast<std::size_t>(members));
  for (std::int32_t i = 0; i < members; ++i) lowest[static_cast<std::size_t>(i)] = i;
  for (bool has_changed = true; has_changed;) {
    has_changed = false;
    for (const auto& [a, b] : pairs) {
      std::int32_t& p = lowest[static_cast<std::size_t>(a)];
      std::int32_t& q = lowest[static_cast<std::size_t>(b)];
      has_changed = has_changed || p != q;
      p = q = std::min(p, q);
    }
  }
  return lowest;
}

TEST(DisjointSets, RootsAreTheLowestThatAreReached) {
  for (const std::size_t count : {0U, 100U, 450U, 2000U}) {
    const Pairs pairs = random_pairs(1000, count);
    const std::vector<std::int32_t> expected = lowest_reached(1000, pairs);
    Sets sets(1000);
    for (const auto& [a, b] : pairs) sets.join(a, b);
    for (std::int32_t i = 0; i < 1000; ++i) {
      EXPECT_EQ(sets.root(i), expected[static_cast<std::size_t>(i)]);
    }
    std::int32_t found = 0;
    const std::vector<std::int32_t> numbers = sets.numbers(&found);
    std::int32_t roots = 0;
    for (std::int32_t i = 0; i < 1000; ++i) {
      const auto at = static_cast<std::size_t>(i);
      if (expected[at] == i) {
        EXPECT_EQ(numbers[at], roots++);
      } else {
        EXPECT_EQ(numbers[at], numbers[static_cast<std::size_t>(expected[at])]);
      }
    }
    EXPECT_EQ(found, roots);
    EXPECT_EQ(std::move(sets).roots(), expected);
  }
}

TEST(DisjointSets, ThreadsJoinAsOneDoes) {
  constexpr std::int32_t kMembers = 20000;
  const Pairs pairs = random_pairs(kMembers, 15000);
  Sets expected(kMembers);
  for (const auto& [a, b] : pairs) expected.join(a, b);
  Sets sets(kMembers);
  std::vector<std::thread> threads;
  for (std::size_t first = 0; first < 4; ++first) {
    threads.emplace_back([&, first] {
      for (std::size_t i = first; i < pairs.size(); i += 4) {
        sets.join_from_threads(pairs[i].first, pairs[i].second);
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(std::move(sets).roots(), std::move(expected).roots());
}

TEST(DisjointSets, GrowByOne) {
  DisjointSets<std::uint32_t> sets;
  EXPECT_EQ(sets.add(), 0U);
  EXPECT_EQ(sets.add(), 1U);
  sets.join(1, 0);
  EXPECT_EQ(sets.add(), 2U);
  EXPECT_EQ(sets.size(), 3U);
  EXPECT_EQ(std::move(sets).roots(), (std::vector<std::uint32_t>{0, 0, 2}));
}

}  // namespace
}  // namespace prefilter
