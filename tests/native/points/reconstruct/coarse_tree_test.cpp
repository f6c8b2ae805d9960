// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/points/reconstruct/coarse_tree.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "points/reconstruct/test_cloud.h"
#include "prefilter/geometry/spatial/morton.h"
#include "prefilter/points/reconstruct/whole_samples.h"

namespace prefilter {
namespace {

constexpr int kDepth = 6;
constexpr int kTop = 4;

TEST(CoarseTree, ExcludesOutliersAndReturnsTheirWeight) {
  testing::CloudStore store(testing::stray_cloud(), kDepth, kDepth - kTop);
  Slabs slabs(&store, kDepth, kTop, 0, true, 1);
  compute_whole_samples(0, prefilter::Run(1), &slabs);
  const double left_out = build_coarse_tree(prefilter::Run(1), &slabs);
  EXPECT_NEAR(left_out, 6.0, 1e-6);
}

TEST(CoarseTree, ContinuesInTheSlabs) {
  testing::CloudStore store(testing::sphere_cloud(20000), kDepth, kDepth - kTop);
  Slabs slabs(&store, kDepth, kTop, 0, true, 1);
  compute_whole_samples(0, prefilter::Run(1), &slabs);
  build_coarse_tree(prefilter::Run(1), &slabs);
  ASSERT_EQ(slabs.coarse.tree.levels.size(), static_cast<std::size_t>(kTop));
  // The split cells of all slabs in order along the curve, and the index of each within its slab.
  std::vector<std::uint64_t> places;
  for (int s = 0; s < slabs.count(); ++s) {
    const std::vector<std::uint64_t>& own = slabs.tree(s)->levels.front().places;
    places.insert(places.end(), own.begin(), own.end());
  }
  std::sort(places.begin(), places.end());
  ASSERT_EQ(slabs.coarse.continuations.size(), places.size());
  for (std::size_t i = 0; i < places.size(); ++i) {
    const CoarseTree::Continuation& each = slabs.coarse.continuations[i];
    EXPECT_EQ(each.slab, morton_cell(places[i])[2]);
    EXPECT_EQ(slabs.tree(each.slab)->levels.front().places[each.block], places[i]);
  }
}

TEST(CoarseTree, IsNegativeForInwardNormals) {
  testing::TestCloud cloud = testing::sphere_cloud(20000);
  for (Vector3& normal : cloud.normals) normal = Vector3{} - normal;
  testing::CloudStore store(cloud, kDepth, kDepth - kTop);
  Slabs slabs(&store, kDepth, kTop, 0, true, 1);
  compute_whole_samples(0, prefilter::Run(1), &slabs);
  build_coarse_tree(prefilter::Run(1), &slabs);
  EXPECT_NEAR(slabs.coarse.root, -4.0 / 3.0 * 3.14159265 * 0.35 * 0.35 * 0.35, 0.005);
}

}  // namespace
}  // namespace prefilter
