// SPDX-License-Identifier: GPL-3.0-or-later

// Octrees of cell means: functions on a cube with adaptive resolution.
//
// Cells of depth k are the 8^k cubes of side 2^-k of the root, the unit cube. A cell is either a
// leaf or split into eight octants, which are stored as a block. Bits 0, 1 and 2 of an octant's
// number are its halves along x, y and z.
#pragma once

#include <array>
#include <bit>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "prefilter/base/run.h"

namespace prefilter {

/// Largest depth of a tree: 4096 cells along an axis.
inline constexpr int kMaxTreeDepth = 12;

/// A value for each octant of a cell.
using OctantValues = std::array<float, 8>;

/// All blocks of one depth, in Morton order (x fastest).
struct TreeLevel {
  std::vector<OctantValues> blocks;
  // Bit o of a block: octant o is split.
  std::vector<std::uint8_t> split;
  // For each block: the index, on the next level, of the block of its first split octant. The
  // blocks of its other split octants follow in order.
  std::vector<std::uint32_t> first;

  std::size_t size() const { return blocks.size(); }
  bool is_split(std::size_t block, int octant) const {
    return ((split[block] >> octant) & 1U) != 0U;
  }
  /// The block, on the next level, of a split octant.
  std::size_t child(std::size_t block, int octant) const {
    assert(is_split(block, octant));
    const unsigned before = split[block] & ((1U << octant) - 1U);
    return first[block] + static_cast<std::size_t>(std::popcount(before));
  }
};

/// An octree of cell means: the value of a split cell is the mean of its octants.
struct CellTree {
  float root = 0.0F;
  // levels[k] contains the cells of depth k + 1; levels[0], if there is one, is a single block. No
  // octant of the last level is split.
  std::vector<TreeLevel> levels;

  /// Depth of the finest cells; 0 if the root is not split.
  int depth() const { return static_cast<int>(levels.size()); }
  /// Number of cells of all depths, including the root.
  std::size_t cell_count() const {
    std::size_t count = 1;
    for (const TreeLevel& level : levels) count += 8 * level.size();
    return count;
  }
};

/// The mean of a block.
float block_mean(const OctantValues& values);

/// Computes `first` of all blocks from `split`.
void link_blocks(TreeLevel* level);

/// Calls body(begin, end) for ranges that cover the level's blocks, in unspecified order.
void for_blocks(const TreeLevel& level, const Run& run,
                const std::function<void(std::size_t, std::size_t)>& body);

/// Computes the values of all split cells, including the root, from the leaves. Throws
/// Error(kCancelled).
void update_means(CellTree* tree, const Run& run);

}  // namespace prefilter
