// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/voxels/cube_table.h"

#include <gtest/gtest.h>

#include <map>
#include <random>

#include "prefilter/voxels/cube_keys.h"

namespace prefilter {
namespace {

// Contents equal a std::map's, on both sides of the origin and with enough entries to grow.
TEST(CubeTable, MatchesAMap) {
  CubeTable<int> table;
  EXPECT_TRUE(table.is_empty());
  std::map<std::uint64_t, int> expected;
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform(-20.0, 20.0);
  const auto any_key = [&] {
    return cube_key({uniform(random), uniform(random), uniform(random)}, 1.0);
  };
  for (int i = 0; i < 20000; ++i) {
    const std::uint64_t key = any_key();
    table[key] += i;
    expected[key] += i;
  }
  ASSERT_EQ(table.size(), expected.size());
  for (int i = 0; i < 20000; ++i) {
    const std::uint64_t key = any_key();
    const int* found = table.find(key);
    const auto same = expected.find(key);
    ASSERT_EQ(found != nullptr, same != expected.end());
    if (found != nullptr) {
      EXPECT_EQ(*found, same->second);
    }
  }
}

// Cubes as far out as keys can represent.
TEST(CubeTable, AcceptsDistantCubes) {
  CubeTable<int> table;
  int count = 0;
  for (const double x : {-1e9, -1e5, 0.0, 1e5, 1e9}) {
    for (const double z : {-1e9, -1e5, 0.0, 1e5, 1e9}) table[cube_key({x, 1.0, z}, 1.0)] = ++count;
  }
  EXPECT_EQ(table.size(), 25U);
  EXPECT_EQ(*table.find(cube_key({1e5, 1.0, -1e5}, 1.0)), 17);
  EXPECT_EQ(table.find(cube_key({1e5, 2.0, -1e5}, 1.0)), nullptr);
}

}  // namespace
}  // namespace prefilter
