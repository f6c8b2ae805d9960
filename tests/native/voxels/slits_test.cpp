// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/voxels/slits.h"

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "prefilter/wavelet/leaf_surface.h"

namespace prefilter {
namespace {

constexpr int kDepth = 2;
constexpr LeafPlace kNeck = {1, 1, 1};

CellTree empty_tree() {
  CellTree tree;
  std::size_t blocks = 1;
  for (int k = 0; k < kDepth; ++k) {
    TreeLevel level;
    level.blocks.assign(blocks, OctantValues{});
    level.split.assign(blocks, k + 1 < kDepth ? 255 : 0);
    link_blocks(&level);
    tree.levels.push_back(std::move(level));
    blocks *= 8;
  }
  return tree;
}

void set(const LeafPlace& at, float value, CellTree* tree) {
  const int outer = (at[0] >> 1) | ((at[1] >> 1) << 1) | ((at[2] >> 1) << 2);
  const int inner = (at[0] & 1) | ((at[1] & 1) << 1) | ((at[2] & 1) << 2);
  TreeLevel& last = tree->levels[1];
  last.blocks[tree->levels[0].child(0, outer)][static_cast<std::size_t>(inner)] = value;
}

// A cell with full neighbors on two sides.
CellTree with_neck(float value) {
  CellTree tree = empty_tree();
  set({0, 1, 1}, 1.0F, &tree);
  set(kNeck, value, &tree);
  set({2, 1, 1}, 1.0F, &tree);
  update_means(&tree, prefilter::Run(1));
  return tree;
}

// Boxes over these ranges of x, from 1 to 2 along y and z.
TriangleMesh boxes(const std::vector<std::array<double, 2>>& ranges) {
  TriangleMesh mesh;
  for (const auto& [low, high] : ranges) {
    const auto first = static_cast<std::int32_t>(mesh.positions.size());
    for (int i = 0; i < 8; ++i) {
      mesh.positions.push_back(
          {(i & 1) != 0 ? high : low, (i & 2) != 0 ? 2.0 : 1.0, (i & 4) != 0 ? 2.0 : 1.0});
    }
    for (const auto& [a, b, c, d] : std::vector<std::array<std::int32_t, 4>>{
             {0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}}) {
      mesh.triangles.push_back({first + a, first + b, first + c});
      mesh.triangles.push_back({first + a, first + c, first + d});
    }
  }
  return mesh;
}

const std::vector<std::array<double, 2>> kApart = {{0.0, 1.3}, {1.7, 3.0}};

CellTree opened(CellTree tree, const TriangleMesh& mesh, const CellTree& thickened = {},
                double unit = 1.0) {
  const WindingNumbers winding({mesh.positions, mesh.triangles}, prefilter::Run(1));
  open_slits(winding, unit, thickened, kDepth, prefilter::Run(1), &tree);
  return tree;
}

float neck_of(const CellTree& tree) { return occupancy_at(tree, kDepth, kNeck); }

TEST(Slits, AreOpenedWhereTheMeshIs) {
  const CellTree tree = opened(with_neck(0.6F), boxes(kApart));
  EXPECT_LT(neck_of(tree), 0.5F);
  EXPECT_GT(neck_of(tree), 0.49F);
  EXPECT_EQ(occupancy_at(tree, kDepth, {0, 1, 1}), 1.0F);
  EXPECT_NEAR(tree.root, (2.0F + neck_of(tree)) / 64.0F, 1e-6F);
  EXPECT_EQ(neck_of(opened(with_neck(0.7F), boxes(kApart))), 0.7F);
}

TEST(Slits, CellsJoinedByTheMeshStay) {
  EXPECT_EQ(neck_of(opened(with_neck(0.6F), boxes({{0.0, 3.0}}))), 0.6F);
  // A slit next to the neck's neighbors, which one of them bridges.
  EXPECT_EQ(neck_of(opened(with_neck(0.6F), boxes({{0.0, 1.3}, {1.2, 3.0}}))), 0.6F);
}

TEST(Slits, ThickenedCellsStay) {
  CellTree thickened = empty_tree();
  set(kNeck, 0.6F, &thickened);
  EXPECT_EQ(neck_of(opened(with_neck(0.6F), boxes(kApart), thickened)), 0.6F);
  EXPECT_LT(neck_of(opened(with_neck(0.6F), boxes(kApart), empty_tree())), 0.5F);
}

TEST(Slits, OnlySoleConnectionsAreOpened) {
  CellTree around = with_neck(0.6F);
  for (const int x : {0, 1, 2}) set({x, 2, 1}, 1.0F, &around);
  EXPECT_EQ(neck_of(opened(std::move(around), boxes(kApart))), 0.6F);
  CellTree end = empty_tree();
  set({0, 1, 1}, 1.0F, &end);
  set(kNeck, 0.6F, &end);
  EXPECT_EQ(neck_of(opened(std::move(end), boxes(kApart))), 0.6F);
}

TEST(Slits, UnitsAreCells) {
  TriangleMesh mesh = boxes(kApart);
  for (Vector3& p : mesh.positions) p = 0.5 * p;
  EXPECT_LT(neck_of(opened(with_neck(0.6F), mesh, {}, 2.0)), 0.5F);
}

}  // namespace
}  // namespace prefilter
