// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/points/reconstruct/slab_walk.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "points/reconstruct/test_cloud.h"
#include "prefilter/points/reconstruct/coarse_tree.h"
#include "prefilter/points/reconstruct/whole_samples.h"

namespace prefilter {
namespace {

constexpr int kDepth = 6;
constexpr int kSlabBits = 2;
constexpr int kSlabs = 1 << (kDepth - kSlabBits);

Slabs slabs_of(SampleStore* store, bool keeps_all) {
  return Slabs(store, kDepth, kDepth - kSlabBits, 0, keeps_all, 1);
}

// Number of stages that a slab passes through up to `stage`.
std::size_t stages_up_to(SlabStage stage) { return static_cast<std::size_t>(stage); }

TEST(SlabWalk, VisitsAllInOrder) {
  const testing::TestCloud cloud = testing::sphere_cloud(5000);
  for (const int threads : {1, 3}) {
    testing::CloudStore store(cloud, kDepth, kSlabBits);
    Slabs slabs = slabs_of(&store, false);
    std::vector<int> visits(kSlabs);
    std::vector<int> joined;
    for_slabs(
        {SlabStage::kCrossedCells}, prefilter::Run(threads), &slabs,
        [&](int s) { ++visits[static_cast<std::size_t>(s)]; }, [&](int s) { joined.push_back(s); });
    std::vector<int> all;
    for (int s = 0; s < kSlabs; ++s) all.push_back(s);
    EXPECT_EQ(visits, std::vector<int>(kSlabs, 1));
    EXPECT_EQ(joined, all);
  }
}

// A walk computes each slab once, although it frees slabs it has passed.
TEST(SlabWalk, ComputesEachStageOnce) {
  const testing::TestCloud cloud = testing::sphere_cloud(5000);
  for (const int threads : {1, 2, 3}) {
    testing::CloudStore store(cloud, kDepth, kSlabBits);
    Slabs slabs = slabs_of(&store, false);
    compute_whole_samples(0, prefilter::Run(threads), &slabs);
    std::size_t expected = kSlabs * stages_up_to(SlabStage::kCrossedCells);
    EXPECT_EQ(slabs.steps(), expected) << threads;
    build_coarse_tree(prefilter::Run(threads), &slabs);
    expected += kSlabs * stages_up_to(SlabStage::kCoefficients);
    EXPECT_EQ(slabs.steps(), expected) << threads;
    for_slabs(
        {SlabStage::kValues, 1, true}, prefilter::Run(threads), &slabs, [](int) {}, [](int) {});
    expected += kSlabs * stages_up_to(SlabStage::kValues);
    EXPECT_EQ(slabs.steps(), expected) << threads;
  }
}

TEST(SlabWalk, FreesSlabsThatAreNoLongerNeeded) {
  const testing::TestCloud cloud = testing::sphere_cloud(5000);
  testing::CloudStore store(cloud, kDepth, kSlabBits);
  Slabs slabs = slabs_of(&store, false);
  compute_whole_samples(0, prefilter::Run(1), &slabs);
  build_coarse_tree(prefilter::Run(1), &slabs);
  const auto is_there = [&](int s) { return !slabs.samples(s)->levels.empty(); };
  for_slabs(
      {SlabStage::kValues, 1, true}, prefilter::Run(1), &slabs, [](int) {},
      [&](int s) {
        for (int t = std::max(s - 1, 0); t <= std::min(s + 1, kSlabs - 1); ++t) {
          EXPECT_TRUE(is_there(t)) << s << " " << t;
        }
        for (int t = 0; t < s - 1; ++t) EXPECT_FALSE(is_there(t)) << s << " " << t;
      });
  for (int s = 0; s < kSlabs; ++s) EXPECT_FALSE(is_there(s));
}

TEST(SlabWalk, KeepsAllSlabsOnRequest) {
  const testing::TestCloud cloud = testing::sphere_cloud(5000);
  testing::CloudStore store(cloud, kDepth, kSlabBits);
  Slabs slabs = slabs_of(&store, true);
  compute_whole_samples(0, prefilter::Run(2), &slabs);
  build_coarse_tree(prefilter::Run(2), &slabs);
  for_slabs(
      {SlabStage::kValues, 1, true}, prefilter::Run(2), &slabs, [](int) {}, [](int) {});
  EXPECT_EQ(slabs.steps(), kSlabs * stages_up_to(SlabStage::kValues));
}

}  // namespace
}  // namespace prefilter
