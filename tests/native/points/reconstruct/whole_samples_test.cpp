// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/points/reconstruct/whole_samples.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <numeric>

#include "points/reconstruct/test_cloud.h"

namespace prefilter {
namespace {

TEST(WholeSamples, LeastLeafIsOneAboveTheMedian) {
  EXPECT_EQ(least_leaf_depth({0, 0, 0, 0, 0, 0, 1}), 5);
  EXPECT_EQ(least_leaf_depth({0, 0, 0, 0, 0, 1, 0.9}), 4);
  EXPECT_EQ(least_leaf_depth({0, 0, 0, 0, 0, 0.9, 1}), 5);
  // A depth with at least half of the weight is chosen.
  EXPECT_EQ(least_leaf_depth({0, 0, 0, 0, 0, 1, 1}), 4);
  EXPECT_EQ(least_leaf_depth({9, 0, 0, 1}), 0);
  EXPECT_EQ(least_leaf_depth({0, 0}), 0);
}

// Expected weights by definition: each finest cell's weight belongs to the deepest crossed cell
// around it, at or below depth kTop.
TEST(WholeSamples, WeightsBelongToTheDeepestCrossedCells) {
  constexpr int kDepth = 6;
  constexpr int kBits = 3;
  constexpr int kTop = kDepth - kBits;
  testing::CloudStore store(testing::sphere_cloud(3000), kDepth, kBits);
  Slabs slabs(&store, kDepth, kTop, 0, true, 1);
  slabs.advance_to(0, slabs.count(), SlabStage::kCrossedCells);
  std::vector<double> found(kDepth + 1);
  std::vector<double> expected(kDepth + 1);
  double all = 0.0;
  for (int s = 0; s < slabs.count(); ++s) {
    const SampleSlab& slab = *slabs.samples(s);
    weigh_leaves(slab, &found);
    std::map<std::pair<int, CellKey>, bool> is_crossed;
    for (int k = kTop; k <= kDepth; ++k) {
      for (std::size_t i = 0; i < slab.at(k).size(); ++i) {
        is_crossed[{k, slab.at(k).samples.cells[i].key}] = slab.at(k).is_crossed(i);
      }
    }
    for (const SampleCell& cell : slab.at(kDepth).samples.cells) {
      CellPosition at = cell_position(cell.key);
      int k = kDepth;
      for (; k > kTop && !is_crossed.at({k, cell_key(at)}); --k)
        at = {at[0] / 2, at[1] / 2, at[2] / 2};
      expected[static_cast<std::size_t>(k)] += static_cast<double>(cell.weight);
      all += static_cast<double>(cell.weight);
    }
  }
  for (std::size_t k = 0; k < expected.size(); ++k) EXPECT_NEAR(found[k], expected[k], 1e-9) << k;
  EXPECT_NEAR(std::accumulate(found.begin(), found.end(), 0.0), all, 1e-9);
  EXPECT_GT(*std::max_element(found.begin(), found.end() - 1), 0.0);
}

TEST(WholeSamples, CombineAllSlabs) {
  constexpr int kDepth = 6;
  constexpr int kTop = 4;
  const testing::TestCloud cloud = testing::sphere_cloud(5000);
  testing::CloudStore store(cloud, kDepth, kDepth - kTop);
  Slabs slabs(&store, kDepth, kTop, 0, true, 1);
  const int largest = compute_whole_samples(0, prefilter::Run(1), &slabs);
  ASSERT_EQ(slabs.offsets.size(), 1U << kTop);
  std::size_t most = 0;
  std::size_t count = 0;
  for (int s = 0; s < slabs.count(); ++s) {
    EXPECT_EQ(slabs.offsets[static_cast<std::size_t>(s)], count);
    count += slabs.samples(s)->at(kTop).size();
    most = std::max(most, slabs.samples(s)->at(kDepth).size());
  }
  EXPECT_EQ(slabs.samples(largest)->at(kDepth).size(), most);
  EXPECT_EQ(slabs.whole.at(kTop).size(), count);
  for (int k = 0; k <= kTop; ++k) {
    double weight = 0.0;
    for (const SampleCell& cell : slabs.whole.at(k).samples.cells) {
      weight += static_cast<double>(cell.weight);
    }
    EXPECT_NEAR(weight, static_cast<double>(cloud.points.size()), 1e-3);
  }
}

}  // namespace
}  // namespace prefilter
