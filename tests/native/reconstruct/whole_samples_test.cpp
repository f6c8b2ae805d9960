// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/reconstruct/whole_samples.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "reconstruct/test_cloud.h"

namespace prefilter {
namespace {

TEST(WholeSamples, AreTheSlabsTogether) {
  constexpr int kDepth = 6;
  constexpr int kTop = 4;
  const testing::TestCloud cloud = testing::sphere_cloud(5000);
  testing::CloudStore store(cloud, kDepth, kDepth - kTop);
  Slabs slabs(&store, kDepth, kTop, 0, true, 1);
  const int largest = find_whole(0, Progress(), 1, &slabs);
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
