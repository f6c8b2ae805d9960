// SPDX-License-Identifier: GPL-3.0-or-later

// Assembles the octree around one slab from the coarse tree and the trees of neighboring slabs.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "prefilter/points/reconstruct/flux_tree.h"
#include "prefilter/points/reconstruct/screened_solve.h"
#include "prefilter/wavelet/cell_tree.h"

namespace prefilter {

/// Coarse levels of an octree whose finer levels are stored per slab, with links into the slabs.
struct CoarseTree {
  FluxTree tree;  // values, from depth 0 to the depth of the slabs' first cells
  float root = 0.0F;
  bool has_surface = true;
  // One entry per split cell of the slabs' first depth, along the Morton curve: its slab, and the
  // index of its block in that slab.
  struct Continuation {
    int slab;
    std::uint32_t block;
  };
  std::vector<Continuation> continuations;

  /// Whether the root itself is not split.
  bool is_empty() const {
    if (!has_surface) return true;
    return tree.levels.empty() ? continuations.empty() : tree.levels.front().places.empty();
  }
};

/// Trees of the slabs below, at and above slab `slab`; null where there is none.
using SlabTrees = std::array<const FluxTree*, 3>;

/// The tree down to `depth` around a slab: all blocks within `octants` of their own octant sides of
/// it, limited to the adjacent slabs. Values are multiplied by `scale`; solved values are used
/// where available.
CellTree assemble(const CoarseTree& coarse, const SlabTrees& trees, int slab, int depth,
                  int octants, float scale);

/// The tree in which a slab is solved, with values from before the solve: all blocks within 8 of
/// their own octant sides of it, limited to the adjacent slabs. `sources` receives the origin of
/// each block.
CellTree assemble_unsolved(const CoarseTree& coarse, const SlabTrees& trees, int slab, int depth,
                           BlockSources* sources);

}  // namespace prefilter
