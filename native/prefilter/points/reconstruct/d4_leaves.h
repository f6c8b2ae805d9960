// SPDX-License-Identifier: GPL-3.0-or-later

// Where samples count in the D4 basis, and for how much.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "prefilter/points/reconstruct/slabs.h"

namespace prefilter {

/// Of each level of a slab, from its first to its finest, for each cell whether it holds leaves as
/// deep as it is.
using LeafFlags = std::vector<std::vector<std::uint8_t>>;

/// Of a slab's finest cells.
struct SlabLeaves {
  std::vector<std::int8_t> leaf;  // the depth at which their samples count
  // The area of a unit of their weight in sides of that leaf squared; 0 for those left out.
  std::vector<float> area;
  double left_out = 0.0;  // the weight of these
  LeafFlags flags;
};

/// The slab has got its leaves.
SlabLeaves find_slab_leaves(const Slabs& slabs, int s);

/// `leaf` tells of the finest cells at which depth they count, and `counts` whether they do.
LeafFlags find_leaf_flags(const SampleSlab& slab, const std::vector<std::uint8_t>& counts,
                          const std::vector<std::int8_t>& leaf);

/// Those of the levels above the slabs', and of their first one.
LeafFlags find_whole_flags(const Slabs& slabs, std::span<const SlabLeaves> leaves);

}  // namespace prefilter
