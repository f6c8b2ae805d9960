// SPDX-License-Identifier: GPL-3.0-or-later

// The surface in each cell as a piece of a plane.
//
// Beyond the text, which gives each leaf the area of its side. A few samples scattered over a cell
// give its flux but roughly; the plane across their mean normal, cut to the cell, gives it to the
// second order. Where such a plane leaves through a face and there are no samples behind it, the
// surface is taken to go on: cells that it merely grazes may have been missed.
#pragma once

#include <vector>

#include "prefilter/points/reconstruct/flux_tree.h"
#include "prefilter/points/reconstruct/leaf_band.h"
#include "prefilter/points/reconstruct/sample_slab.h"

namespace prefilter {

/// The samples of a depth in a slab, and in those below and above it, and of the depth above in the
/// same slab; null where there are none.
struct PatchLevels {
  const SampleLevel* below;
  const SampleLevel* own;
  const SampleLevel* above;
  const SampleLevel* coarser;
};

/// Adds the pieces in the cells of one depth of a slab whose samples count there, and in those
/// between them. The slab is from `low` up to `high`, in cells. In cells that are split the pieces
/// are cut further.
void add_patches(const PatchLevels& levels, int depth, int low, int high, const SplitCells& splits,
                 PooledFlux* flux);

}  // namespace prefilter
