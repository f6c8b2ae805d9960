// SPDX-License-Identifier: GPL-3.0-or-later

// Which cells the function is told in, in the D4 basis: those that hold leaves as deep as their
// octants, or are next to such a leaf. The values of the trees are not set.
#pragma once

#include <span>
#include <vector>

#include "prefilter/points/reconstruct/assemble.h"
#include "prefilter/points/reconstruct/d4_leaves.h"
#include "prefilter/points/reconstruct/flux_tree.h"
#include "prefilter/points/reconstruct/sample_cell.h"
#include "prefilter/points/reconstruct/slabs.h"

namespace prefilter {

/// The tree of slab `s`.
FluxTree split_slab(const Slabs& slabs, std::span<const SlabLeaves> leaves, int s);

/// The tree above those of all slabs.
CoarseTree split_whole(const Slabs& slabs, const LeafFlags& flags, std::span<const FluxTree> trees);

}  // namespace prefilter
