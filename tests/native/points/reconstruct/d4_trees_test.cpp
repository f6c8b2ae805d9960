// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/points/reconstruct/d4_trees.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>

#include "points/reconstruct/test_cloud.h"
#include "prefilter/geometry/spatial/morton.h"
#include "prefilter/points/reconstruct/split_finder.h"
#include "prefilter/points/reconstruct/whole_samples.h"

namespace prefilter {
namespace {

constexpr int kDepth = 6;
constexpr int kTop = 4;

// The parents of the cells and of their 26 neighbors each.
std::set<std::uint64_t> parents_of(const std::vector<CellPosition>& cells, int depth, int low,
                                   int high) {
  std::set<std::uint64_t> places;
  const int side = 1 << depth;
  for (const CellPosition& cell : cells) {
    for (int n = 0; n < 27; ++n) {
      const CellPosition at = {cell[0] + n % 3 - 1, cell[1] + n / 3 % 3 - 1, cell[2] + n / 9 - 1};
      if (*std::min_element(at.begin(), at.end()) < 0) continue;
      if (*std::max_element(at.begin(), at.end()) >= side) continue;
      if (at[2] / 2 < low || at[2] / 2 >= high) continue;
      places.insert(morton_index({at[0] / 2, at[1] / 2, at[2] / 2}));
    }
  }
  return places;
}

TEST(SplitFinder, FindsTheParentsOfCellsAndTheirNeighbors) {
  std::mt19937 random(1);
  for (const int count : {1, 5, 200, 30000}) {
    std::uniform_int_distribution<int> place(0, (1 << kDepth) - 1);
    std::vector<CellPosition> cells;
    for (int i = 0; i < count; ++i) cells.push_back({place(random), place(random), place(random)});
    for (const auto& [low, high] : {std::pair(0, 32), std::pair(7, 12)}) {
      SplitFinder finder(kDepth, low, high);
      for (const CellPosition& cell : cells) finder.add(cell);
      const std::set<std::uint64_t> expected = parents_of(cells, kDepth, low, high);
      EXPECT_EQ(finder.take(), std::vector<std::uint64_t>(expected.begin(), expected.end()));
    }
  }
}

class D4Trees : public ::testing::Test {
 protected:
  D4Trees()
      : store_(testing::uneven_sphere_cloud(), kDepth, kDepth - kTop),
        slabs_(&store_, kDepth, kTop, 0, true, 1) {
    compute_whole_samples(0, prefilter::Run(1), &slabs_);
    slabs_.advance_to(0, slabs_.count(), SlabStage::kLeaves);
    for (int s = 0; s < slabs_.count(); ++s) leaves_.push_back(find_slab_leaves(slabs_, s));
  }

  // The cells of depth k that contain leaves of depth k or deeper.
  std::vector<CellPosition> cells_with_leaves(int k) const {
    std::set<CellPosition> cells;
    for (int s = 0; s < slabs_.count(); ++s) {
      const SampleLevel& finest = slabs_.samples(s)->at(kDepth);
      for (std::size_t i = 0; i < finest.size(); ++i) {
        if (finest.leaf[i] < k) continue;
        const CellPosition at = cell_position(finest.samples.cells[i].key);
        const int shift = kDepth - k;
        cells.insert({at[0] >> shift, at[1] >> shift, at[2] >> shift});
      }
    }
    return {cells.begin(), cells.end()};
  }

  testing::CloudStore store_;
  Slabs slabs_;
  std::vector<SlabLeaves> leaves_;
};

TEST_F(D4Trees, SlabsAreSplitAroundLeaves) {
  std::set<int> depths;
  for (int s = 0; s < slabs_.count(); ++s) {
    const FluxTree tree = split_slab(slabs_, leaves_, s);
    EXPECT_EQ(tree.top, kTop);
    ASSERT_EQ(tree.levels.size(), static_cast<std::size_t>(kDepth - kTop));
    for (int k = kTop + 1; k <= kDepth; ++k) {
      const int height = 1 << (k - 1 - kTop);
      const std::set<std::uint64_t> expected =
          parents_of(cells_with_leaves(k), k, s * height, (s + 1) * height);
      const NodeLevel& level = tree.levels[static_cast<std::size_t>(k - kTop - 1)];
      EXPECT_EQ(level.places, std::vector<std::uint64_t>(expected.begin(), expected.end()));
      if (!expected.empty()) depths.insert(k);
      // An octant is split if and only if the next level has a block for it.
      for (std::size_t b = 0; b < level.places.size(); ++b) {
        for (unsigned o = 0; o < 8; ++o) {
          const bool is_split = (level.blocks.split[b] >> o & 1U) != 0;
          const std::uint64_t octant = level.places[b] << 3U | o;
          const bool is_there =
              k < kDepth && std::binary_search(tree.levels.back().places.begin(),
                                               tree.levels.back().places.end(), octant);
          EXPECT_EQ(is_split, is_there);
        }
      }
    }
  }
  EXPECT_EQ(depths.size(), static_cast<std::size_t>(kDepth - kTop));
}

TEST_F(D4Trees, TheCoarseTreeIsSplitAroundLeaves) {
  std::vector<FluxTree> trees;
  std::size_t firsts = 0;
  for (int s = 0; s < slabs_.count(); ++s) {
    trees.push_back(split_slab(slabs_, leaves_, s));
    firsts += trees.back().levels.front().places.size();
  }
  const CoarseTree whole = split_whole(slabs_, find_whole_flags(slabs_, leaves_), trees);
  ASSERT_EQ(whole.tree.levels.size(), static_cast<std::size_t>(kTop));
  for (int k = 1; k <= kTop; ++k) {
    const std::set<std::uint64_t> expected = parents_of(cells_with_leaves(k), k, 0, 1 << k);
    EXPECT_EQ(whole.tree.levels[static_cast<std::size_t>(k - 1)].places,
              std::vector<std::uint64_t>(expected.begin(), expected.end()));
  }
  ASSERT_EQ(whole.continuations.size(), firsts);
  std::vector<std::uint32_t> next(trees.size());
  for (const CoarseTree::Continuation& each : whole.continuations) {
    EXPECT_EQ(each.block, next[static_cast<std::size_t>(each.slab)]++);
  }
}

TEST_F(D4Trees, AreasSumUpToTheSphere) {
  double weight = 0.0;
  double area = 0.0;
  for (int s = 0; s < slabs_.count(); ++s) {
    const SlabLeaves& leaves = leaves_[static_cast<std::size_t>(s)];
    const std::vector<SampleCell>& cells = slabs_.samples(s)->at(kDepth).samples.cells;
    weight += leaves.left_out;
    for (std::size_t i = 0; i < cells.size(); ++i) {
      if (leaves.leaf[i] < 0) {
        EXPECT_EQ(leaves.area[i], 0.0F);
        continue;
      }
      EXPECT_GT(leaves.area[i], 0.0F);
      weight += static_cast<double>(cells[i].weight);
      // In squares of a finest cell's side.
      area += std::ldexp(static_cast<double>(leaves.area[i] * cells[i].weight),
                         2 * (kDepth - leaves.leaf[i]));
    }
  }
  EXPECT_NEAR(weight, static_cast<double>(testing::uneven_sphere_cloud().points.size()), 1e-3);
  const double radius = 0.35 * 64.0;
  // Areas are sums over cells two depths up, some of which the border of the sparse half crosses.
  EXPECT_NEAR(area, 4.0 * 3.14159265 * radius * radius, 0.12 * 4.0 * 3.14159265 * radius * radius);
}

TEST(D4Leaves, ExcludeOutliers) {
  testing::CloudStore store(testing::stray_cloud(), kDepth, kDepth - kTop);
  Slabs slabs(&store, kDepth, kTop, 0, true, 1);
  compute_whole_samples(0, prefilter::Run(1), &slabs);
  slabs.advance_to(0, slabs.count(), SlabStage::kLeaves);
  double left_out = 0.0;
  for (int s = 0; s < slabs.count(); ++s) left_out += find_slab_leaves(slabs, s).left_out;
  EXPECT_NEAR(left_out, 6.0, 1e-6);
}

}  // namespace
}  // namespace prefilter
