// SPDX-License-Identifier: GPL-3.0-or-later

// Structure of the octrees in the D4 basis: cells that contain, or are next to, leaves as deep as
// their octants are split. The trees' values are not set.
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

/// The coarse tree above the trees of all slabs.
CoarseTree split_whole(const Slabs& slabs, const LeafFlags& flags, std::span<const FluxTree> trees);

}  // namespace prefilter
