// SPDX-License-Identifier: GPL-3.0-or-later

// Functions on a cube that are known cell by cell, finely only where they need to be: an octree of
// cell means.
//
// Cells of depth k are the 8^k cubes of side 2^-k of the root, the unit cube. A cell that is split
// has all of its eight octants as a block. Bit 0 of an octant's number is its half along x, bit 1
// along y, bit 2 along z.
#pragma once

#include <array>
#include <bit>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "prefilter/base/progress.h"

namespace prefilter {

/// Depth of the finest cells there can be: 4096 along an axis.
inline constexpr int kMaxTreeDepth = 12;

/// A value for each of the octants of a cell.
using OctantValues = std::array<float, 8>;

/// All blocks of one depth, along the Morton curve (x fastest).
struct TreeLevel {
  std::vector<OctantValues> blocks;
  // Bit o of a block: octant o is split.
  std::vector<std::uint8_t> split;
  // Of a block: the index, on the next level, of the block of its first octant that is split. Those
  // of its other octants follow in order.
  std::vector<std::uint32_t> first;

  std::size_t size() const { return blocks.size(); }
  bool is_split(std::size_t block, int octant) const {
    return ((split[block] >> octant) & 1U) != 0U;
  }
  /// The block, on the next level, of an octant that is split.
  std::size_t child(std::size_t block, int octant) const {
    assert(is_split(block, octant));
    const unsigned before = split[block] & ((1U << octant) - 1U);
    return first[block] + static_cast<std::size_t>(std::popcount(before));
  }
};

/// An octree of cell means: the value of a cell that is split is the mean of its octants'.
struct CellTree {
  float root = 0.0F;
  // levels[k] holds the cells of depth k + 1; levels[0], where there is one, is a single block. No
  // octant of the last level is split.
  std::vector<TreeLevel> levels;

  /// Of the finest cells: 0 where the root is not split.
  int depth() const { return static_cast<int>(levels.size()); }
  /// Cells of all depths, the root included.
  std::size_t cell_count() const {
    std::size_t count = 1;
    for (const TreeLevel& level : levels) count += 8 * level.size();
    return count;
  }
};

/// The mean of a block.
float block_mean(const OctantValues& values);

/// Sets `first` of all blocks, from `split`.
void link_blocks(TreeLevel* level);

/// Calls body(begin, end) for ranges that cover the level's blocks, in no set order.
void for_blocks(const TreeLevel& level, int threads, const Progress& progress,
                const std::function<void(std::size_t, std::size_t)>& body);

/// Sets the values of all cells that are split, and of the root where it is, from the leaves.
/// Throws Error(kCancelled).
void update_means(CellTree* tree, const Progress& progress, int threads);

}  // namespace prefilter
