// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/wavelet/haar.h"

#include <gtest/gtest.h>

#include <random>

#include "prefilter/geometry/spatial/morton.h"

namespace prefilter {
namespace {

TEST(Haar, TransformIsTheSumWithSigns) {
  std::mt19937 random(2);
  std::uniform_real_distribution<float> uniform(-1.0F, 1.0F);
  OctantValues values;
  for (float& value : values) value = uniform(random);
  OctantValues transformed = values;
  hadamard(&transformed);
  for (unsigned o = 0; o < 8; ++o) {
    float sum = 0.0F;
    for (unsigned e = 0; e < 8; ++e) sum += std::popcount(e & o) % 2 == 0 ? values[e] : -values[e];
    EXPECT_NEAR(transformed[o], sum, 1e-6);
  }
}

TEST(Haar, SynthesisClampsAndTakesRoundingBack) {
  HaarTree tree;
  tree.mean = 0.5;
  tree.levels.resize(1);
  tree.levels[0].blocks.push_back({0.0F, 0.500001F, 0.0F, 0.0F, 0.0F, 0.0F, 0.0F, 0.0F});
  tree.levels[0].split.push_back(0);
  const CellTree cells = synthesise(tree, -1, prefilter::Run(1));
  for (std::size_t o = 0; o < 8; ++o) {
    EXPECT_EQ(cells.levels[0].blocks[0][o], o % 2 == 0 ? 1.0F : 0.0F);
  }
  EXPECT_EQ(cells.root, 0.5F);
}

TEST(Morton, RoundTrips) {
  std::mt19937 random(3);
  std::uniform_int_distribution<int> coordinate(0, 1023);
  for (int i = 0; i < 1000; ++i) {
    const std::array<int, 3> cell = {coordinate(random), coordinate(random), coordinate(random)};
    EXPECT_EQ(morton_cell(morton_index(cell)), cell);
  }
  EXPECT_EQ(morton_index({1, 0, 0}), 1U);
  EXPECT_EQ(morton_index({0, 1, 0}), 2U);
  EXPECT_EQ(morton_index({0, 0, 1}), 4U);
  EXPECT_EQ(morton_index({2, 0, 0}), 8U);
}

}  // namespace
}  // namespace prefilter
