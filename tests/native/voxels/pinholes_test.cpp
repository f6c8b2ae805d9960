// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/voxels/pinholes.h"

#include <gtest/gtest.h>

#include <utility>

#include "prefilter/wavelet/leaf_surface.h"

namespace prefilter {
namespace {

constexpr int kDepth = 2;

// A tree with leaves at one depth, all of this value.
CellTree uniform(float value) {
  CellTree tree;
  std::size_t blocks = 1;
  for (int k = 0; k < kDepth; ++k) {
    TreeLevel level;
    OctantValues values;
    values.fill(value);
    level.blocks.assign(blocks, values);
    level.split.assign(blocks, k + 1 < kDepth ? 255 : 0);
    link_blocks(&level);
    tree.levels.push_back(std::move(level));
    blocks *= 8;
  }
  update_means(&tree, prefilter::Run(1));
  return tree;
}

void set(const LeafPlace& at, float value, CellTree* tree) {
  const int parent = at[0] / 2 + 2 * (at[1] / 2) + 4 * (at[2] / 2);
  const int o = at[0] % 2 + 2 * (at[1] % 2) + 4 * (at[2] % 2);
  tree->levels[1].blocks[static_cast<std::size_t>(parent)][static_cast<std::size_t>(o)] = value;
}

constexpr LeafPlace kCell = {1, 1, 1};

// An otherwise empty tree with the cell kCell and this many full neighbors.
CellTree around(float value, int full) {
  CellTree tree = uniform(0.0F);
  set(kCell, value, &tree);
  for (int k = 0; k < full; ++k) {
    LeafPlace at = kCell;
    at[static_cast<std::size_t>(k % 3)] += k < 3 ? 1 : -1;
    set(at, 0.9F, &tree);
  }
  update_means(&tree, prefilter::Run(1));
  return tree;
}

float filled(CellTree tree, const CellTree& thickened) {
  fill_pinholes(thickened, kDepth, prefilter::Run(1), &tree);
  return occupancy_at(tree, kDepth, kCell);
}

TEST(Pinholes, AreFilledBetweenFourFullNeighbors) {
  const CellTree everywhere = uniform(0.1F);
  EXPECT_GT(filled(around(0.45F, 4), everywhere), 0.5F);
  EXPECT_GT(filled(around(0.5F, 6), everywhere), 0.5F);
  EXPECT_EQ(filled(around(0.45F, 3), everywhere), 0.45F);
  EXPECT_EQ(filled(around(0.3F, 6), everywhere), 0.3F);
}

TEST(Pinholes, OnlyThickenedCellsAreFilled) {
  CellTree elsewhere = uniform(0.0F);
  set({3, 3, 3}, 0.7F, &elsewhere);
  EXPECT_EQ(filled(around(0.45F, 6), elsewhere), 0.45F);
  EXPECT_EQ(filled(around(0.45F, 6), CellTree()), 0.45F);
}

TEST(Pinholes, MeansIncludeFilledCells) {
  CellTree tree = around(0.45F, 6);
  const float before = tree.root;
  fill_pinholes(uniform(0.1F), kDepth, prefilter::Run(1), &tree);
  EXPECT_NEAR(tree.root - before, (0.505F - 0.45F) / 64.0F, 1e-6F);
}

}  // namespace
}  // namespace prefilter
