// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/wavelet/smooth.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

#include "prefilter/geometry/spatial/morton.h"
#include "wavelet/random_tree.h"

namespace prefilter {
namespace {

using Place = std::array<int, 3>;

// The value of a cell of some depth, or of the larger leaf that contains it; 0 outside the root.
float value_at(const CellTree& tree, int depth, const Place& cell) {
  for (const int x : cell) {
    if (x < 0 || x >= 1 << depth) return 0.0F;
  }
  float value = tree.root;
  std::size_t block = 0;
  for (int k = 0; k < depth; ++k) {
    const int shift = depth - k - 1;
    int o = 0;
    for (std::size_t a = 0; a < 3; ++a) o |= ((cell[a] >> shift) & 1) << a;
    const TreeLevel& level = tree.levels[static_cast<std::size_t>(k)];
    value = level.blocks[block][static_cast<std::size_t>(o)];
    if (k + 1 == depth || !level.is_split(block, o)) break;
    block = level.child(block, o);
  }
  return value;
}

double convolved(const CellTree& tree, int depth, const Place& cell) {
  double sum = 0.0;
  for (int z = -1; z <= 1; ++z) {
    for (int y = -1; y <= 1; ++y) {
      for (int x = -1; x <= 1; ++x) {
        const double weight = std::ldexp(1.0, -3 - std::abs(x) - std::abs(y) - std::abs(z));
        const Place at = {cell[0] + x, cell[1] + y, cell[2] + z};
        sum += weight * static_cast<double>(value_at(tree, depth, at));
      }
    }
  }
  return sum;
}

// Calls visit(depth, cell, is_leaf) for all cells except the root.
template <typename Visit>
void for_cells(const CellTree& tree, std::size_t level, std::size_t block, const Place& cell,
               const Visit& visit) {
  const TreeLevel& blocks = tree.levels[level];
  for (int o = 0; o < 8; ++o) {
    const Place octant = {2 * cell[0] + (o & 1), 2 * cell[1] + ((o >> 1) & 1), 2 * cell[2] + o / 4};
    visit(static_cast<int>(level) + 1, octant, !blocks.is_split(block, o));
    if (blocks.is_split(block, o)) {
      for_cells(tree, level + 1, blocks.child(block, o), octant, visit);
    }
  }
}

CellTree full_tree(int depth) {
  CellTree tree = random_tree(9, 1);
  for (int k = 1; k < depth; ++k) {
    TreeLevel& above = tree.levels.back();
    above.split.assign(above.size(), 255);
    link_blocks(&above);
    TreeLevel level;
    for (std::size_t i = 0; i < 8 * above.size(); ++i) {
      OctantValues block;
      for (std::size_t o = 0; o < 8; ++o) block[o] = static_cast<float>((31 * i + 7 * o) % 17);
      level.blocks.push_back(block);
    }
    level.split.resize(level.size());
    link_blocks(&level);
    tree.levels.push_back(std::move(level));
  }
  update_means(&tree, prefilter::Run(1));
  return tree;
}

TEST(SmoothLeaves, IsAConvolutionOnAGrid) {
  constexpr int kDepth = 3;
  constexpr int kSide = 1 << kDepth;
  const CellTree tree = full_tree(kDepth);
  std::array<double, (kSide + 2) * (kSide + 2) * (kSide + 2)> grid{};
  const auto at = [](int x, int y, int z) {
    return static_cast<std::size_t>(((z + 1) * (kSide + 2) + y + 1) * (kSide + 2) + x + 1);
  };
  for (std::uint64_t i = 0; i < kSide * kSide * kSide; ++i) {
    const Place cell = morton_cell(i);
    grid[at(cell[0], cell[1], cell[2])] =
        static_cast<double>(tree.levels.back().blocks[i / 8][i % 8]);
  }
  for (const std::size_t stride : {at(0, -1, -1), at(-1, 0, -1), at(-1, -1, 0)}) {
    const auto before = grid;
    for (std::uint64_t i = 0; i < kSide * kSide * kSide; ++i) {
      const Place cell = morton_cell(i);
      const std::size_t c = at(cell[0], cell[1], cell[2]);
      grid[c] = before[c] / 2.0 + (before[c - stride] + before[c + stride]) / 4.0;
    }
  }
  CellTree smoothed = tree;
  smooth_leaves(&smoothed);
  for (std::uint64_t i = 0; i < kSide * kSide * kSide; ++i) {
    const Place cell = morton_cell(i);
    EXPECT_NEAR(static_cast<double>(smoothed.levels.back().blocks[i / 8][i % 8]),
                grid[at(cell[0], cell[1], cell[2])], 1e-5);
  }
}

TEST(SmoothLeaves, TakesLargerLeavesForNeighbors) {
  for (unsigned seed = 0; seed < 5; ++seed) {
    const CellTree tree = random_tree(seed, 5);
    CellTree smoothed = tree;
    smooth_leaves(&smoothed);
    EXPECT_EQ(smoothed.root, tree.root);
    for_cells(tree, 0, 0, {0, 0, 0}, [&](int depth, const Place& cell, bool is_leaf) {
      const float found = value_at(smoothed, depth, cell);
      if (is_leaf) {
        EXPECT_NEAR(static_cast<double>(found), convolved(tree, depth, cell), 1e-6);
      } else {
        EXPECT_EQ(found, value_at(tree, depth, cell));
      }
    });
  }
}

TEST(SmoothLeaves, LeavesARootWithoutCellsAsItIs) {
  CellTree tree;
  tree.root = 0.25F;
  smooth_leaves(&tree);
  EXPECT_EQ(tree.root, 0.25F);
  EXPECT_TRUE(tree.levels.empty());
}

}  // namespace
}  // namespace prefilter
