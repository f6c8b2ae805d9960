// SPDX-License-Identifier: GPL-3.0-or-later

// The leaves of a tree by their place.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "prefilter/wavelet/cell_tree.h"

namespace prefilter {

/// A leaf as a cell of its level.
struct TreeLeaf {
  int depth;
  std::size_t cell;  // on level depth - 1: 8 * block + octant

  std::size_t level() const { return static_cast<std::size_t>(depth - 1); }
};

/// The leaf that is or holds a cell of depth `depth`, within the root of a tree that has levels.
inline TreeLeaf leaf_at(const CellTree& tree, int depth, const std::array<std::int32_t, 3>& at) {
  std::size_t block = 0;
  for (int k = 1;; ++k) {
    const int shift = depth - k;
    const int o =
        ((at[0] >> shift) & 1) | ((at[1] >> shift) & 1) << 1 | ((at[2] >> shift) & 1) << 2;
    const TreeLevel& level = tree.levels[static_cast<std::size_t>(k - 1)];
    if (!level.is_split(block, o)) return {k, 8 * block + static_cast<std::size_t>(o)};
    block = level.child(block, o);
  }
}

/// A cell of a tree, split or not.
struct TreeCell {
  TreeLeaf place;
  bool is_leaf;
};

/// The cell of depth `depth` there, or the larger leaf that holds it; none outside of the root.
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
    if (k == depth || is_leaf)
      return TreeCell{{k, 8 * block + static_cast<std::size_t>(o)}, is_leaf};
    block = level.child(block, o);
  }
}

}  // namespace prefilter
