// SPDX-License-Identifier: GPL-3.0-or-later

// The tree around a slab, put together from the parts that are kept.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "prefilter/points/reconstruct/flux_tree.h"
#include "prefilter/points/reconstruct/screened_solve.h"
#include "prefilter/wavelet/cell_tree.h"

namespace prefilter {

/// The coarse levels of a tree whose finer ones are in slabs, and where these go on.
struct CoarseTree {
  FluxTree tree;  // values, from depth 0 to that of the slabs' first cells
  float root = 0.0F;
  bool has_surface = true;
  // Of each cell of the slabs' first depth that is split, along the Morton curve: its slab, and its
  // number among the slab's blocks.
  struct Continuation {
    int slab;
    std::uint32_t block;
  };
  std::vector<Continuation> continuations;

  /// Whether not even the root is split.
  bool is_empty() const {
    if (!has_surface) return true;
    return tree.levels.empty() ? continuations.empty() : tree.levels.front().places.empty();
  }
};

/// The slabs below, at and above the one; null where there is none.
using SlabTrees = std::array<const FluxTree*, 3>;

/// The tree of `depth` as the slab needs it: all blocks that reach within `octants` of their
/// octants of it, but no farther than the slabs next to it, and the values times `scale`: those
/// solved for, where there are.
CellTree assemble(const CoarseTree& coarse, const SlabTrees& trees, int slab, int depth,
                  int octants, float scale);

/// The tree that a slab is solved in, of the values before: all blocks within some of their octants
/// of it and no farther than the slabs next to it.
CellTree assemble_unsolved(const CoarseTree& coarse, const SlabTrees& trees, int slab, int depth,
                           BlockSources* sources);

}  // namespace prefilter
