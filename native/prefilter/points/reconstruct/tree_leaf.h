// SPDX-License-Identifier: GPL-3.0-or-later

// Finds cells and leaves of an octree by position.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "prefilter/wavelet/cell_tree.h"

namespace prefilter {

/// A cell, identified by its level and index.
struct TreeCell {
  int depth;
  std::size_t cell;  // on level depth - 1: 8 * block + octant
  bool is_leaf;

  std::size_t level() const { return static_cast<std::size_t>(depth - 1); }
};

/// The cell at coordinates `at` of depth `depth`, or the larger leaf that contains it; none outside
/// the root. The tree must have at least one level.
inline std::optional<TreeCell> cell_at(const CellTree& tree, int depth,
                                       const std::array<std::int32_t, 3>& at) {
  for (const std::int32_t x : at) {
    if (x < 0 || x >= 1 << depth) return std::nullopt;
  }
  std::size_t block = 0;
  for (int k = 1;; ++k) {
    const int shift = depth - k;
    const int o =
        ((at[0] >> shift) & 1) | ((at[1] >> shift) & 1) << 1 | ((at[2] >> shift) & 1) << 2;
    const TreeLevel& level = tree.levels[static_cast<std::size_t>(k - 1)];
    const bool is_leaf = !level.is_split(block, o);
    if (k == depth || is_leaf) {
      return TreeCell{k, 8 * block + static_cast<std::size_t>(o), is_leaf};
    }
    block = level.child(block, o);
  }
}

/// The value of a cell.
inline float& value_of(const TreeCell& cell, CellTree* tree) {
  return tree->levels[cell.level()].blocks[cell.cell / 8][cell.cell % 8];
}
inline float value_of(const TreeCell& cell, const CellTree& tree) {
  return tree.levels[cell.level()].blocks[cell.cell / 8][cell.cell % 8];
}

}  // namespace prefilter
