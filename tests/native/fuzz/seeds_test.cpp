// SPDX-License-Identifier: GPL-3.0-or-later

// What the fuzzer begins with, and some damage to it: targets stay what they say, also where
// libFuzzer does not run.

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <vector>

#include "fuzz/targets.h"

namespace prefilter {
namespace {

namespace fs = std::filesystem;

std::vector<std::uint8_t> bytes_of(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

std::vector<fs::path> seeds_of(const FuzzTarget& target) {
  std::vector<fs::path> paths;
  for (const auto& entry : fs::directory_iterator(fs::path(PREFILTER_SEEDS) / target.name)) {
    paths.push_back(entry.path());
  }
  std::sort(paths.begin(), paths.end());
  return paths;
}

TEST(FuzzTargets, ReturnForTheirSeedsAndDamagedOnes) {
  constexpr int kDamaged = 20;
  std::mt19937 random(1);
  const auto below = [&](std::size_t count) { return random() % count; };
  for (const FuzzTarget& target : fuzz_targets()) {
    SCOPED_TRACE(target.name);
    const std::vector<fs::path> seeds = seeds_of(target);
    EXPECT_FALSE(seeds.empty());
    for (const fs::path& seed : seeds) {
      const std::vector<std::uint8_t> whole = bytes_of(seed);
      ASSERT_FALSE(whole.empty()) << seed;
      EXPECT_NO_THROW(target.read(whole)) << seed;
      for (int k = 0; k < kDamaged; ++k) {
        std::vector<std::uint8_t> damaged = whole;
        damaged[below(damaged.size())] = static_cast<std::uint8_t>(random());
        if (k % 4 == 0) damaged.resize(below(damaged.size()));
        EXPECT_NO_THROW(target.read(damaged)) << seed << ", " << k;
      }
    }
  }
}

}  // namespace
}  // namespace prefilter
