// SPDX-License-Identifier: GPL-3.0-or-later

// Represents the surface in each leaf by a planar patch.
//
// Not in the dissertation, which gives each leaf the area of one side. A few samples scattered over
// a cell approximate its flux poorly; the plane through their mean, across their mean normal and
// clipped to the cell, gives it to second order. Where such a plane leaves its cell into one
// without samples, the surface is assumed to continue: cells that it barely touches may contain no
// sample.
#pragma once

#include <vector>

#include "prefilter/points/reconstruct/flux_tree.h"
#include "prefilter/points/reconstruct/leaf_band.h"
#include "prefilter/points/reconstruct/sample_slab.h"

namespace prefilter {

/// The sample levels of one depth in a slab and the slabs below and above it, and the next coarser
/// level in the same slab; null where there are none.
struct PatchLevels {
  const SampleLevel* below;
  const SampleLevel* own;
  const SampleLevel* above;
  const SampleLevel* coarser;
};

/// Adds the patches of one depth: in the slab's cells whose samples count at this depth, and in the
/// gaps between them. The slab reaches from `low` up to `high`, in cells. In split cells the
/// patches are clipped to the octants.
void add_patches(const PatchLevels& levels, int depth, int low, int high, const SplitCells& splits,
                 PooledFlux* flux);

}  // namespace prefilter
