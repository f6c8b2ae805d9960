// SPDX-License-Identifier: GPL-3.0-or-later

// Visits and changes the finest leaves of a tree.
#pragma once

#include <cstddef>

#include "prefilter/wavelet/leaf_surface.h"

namespace prefilter {

/// Calls visit(position, value) for the nonempty leaves of the tree's depth, in order of their
/// blocks.
template <typename Visit>
void for_finest(const CellTree& tree, const Visit& visit, int level = 0, std::size_t block = 0,
                const LeafPlace& at = {0, 0, 0}) {
  const TreeLevel& here = tree.levels[static_cast<std::size_t>(level)];
  for (int o = 0; o < 8; ++o) {
    const LeafPlace octant = octant_place(at, o);
    if (here.is_split(block, o)) {
      for_finest(tree, visit, level + 1, here.child(block, o), octant);
    } else if (level + 1 == tree.depth()) {
      const float value = here.blocks[block][static_cast<std::size_t>(o)];
      if (value > 0.0F) visit(octant, value);
    }
  }
}

/// Sets the value of a leaf of the finest depth; does nothing if there is none at that position.
inline void set_leaf(const LeafPlace& at, int depth, float value, CellTree* cells) {
  std::size_t block = 0;
  for (int k = 0; k < depth; ++k) {
    const int shift = depth - k - 1;
    const int o =
        ((at[0] >> shift) & 1) | (((at[1] >> shift) & 1) << 1) | (((at[2] >> shift) & 1) << 2);
    TreeLevel& level = cells->levels[static_cast<std::size_t>(k)];
    if (k + 1 == depth) {
      level.blocks[block][static_cast<std::size_t>(o)] = value;
    } else if (!level.is_split(block, o)) {
      return;
    } else {
      block = level.child(block, o);
    }
  }
}

}  // namespace prefilter
