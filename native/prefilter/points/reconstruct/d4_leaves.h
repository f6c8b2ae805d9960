// SPDX-License-Identifier: GPL-3.0-or-later

// Leaves and sample areas in the D4 basis.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "prefilter/points/reconstruct/slabs.h"

namespace prefilter {

/// For each level of a slab, from its first to its finest, and each cell: whether it contains
/// leaves of its own depth or deeper.
using LeafFlags = std::vector<std::vector<std::uint8_t>>;

/// Leaf data for a slab's finest cells.
struct SlabLeaves {
  std::vector<std::int8_t> leaf;  // depth of the leaf in which their samples count; -1 for outliers
  // Area per unit of sample weight, in squared sides of that leaf; 0 for outliers.
  std::vector<float> area;
  double left_out = 0.0;  // total weight of the outliers
  LeafFlags flags;
};

/// Finds the leaf data of slab `s`, which must be at SlabStage::kLeaves.
SlabLeaves find_slab_leaves(const Slabs& slabs, int s);

/// `leaf` is the depth at which the samples of each finest cell count, and `counts` whether they
/// do.
LeafFlags find_leaf_flags(const SampleSlab& slab, const std::vector<std::uint8_t>& counts,
                          const std::vector<std::int8_t>& leaf);

/// Flags of the levels above the slabs, and of the slabs' first level.
LeafFlags find_whole_flags(const Slabs& slabs, std::span<const SlabLeaves> leaves);

}  // namespace prefilter
