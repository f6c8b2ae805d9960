// SPDX-License-Identifier: GPL-3.0-or-later

// The levels of the tree above the slabs', in the Haar basis.
#pragma once

#include <vector>

#include "prefilter/base/progress.h"
#include "prefilter/points/reconstruct/assemble.h"
#include "prefilter/points/reconstruct/slabs.h"

namespace prefilter {

/// The coefficients of all slabs, in the cells of `top` and above, to values. `flux` has what
/// samples give at each depth up to `top`; the last are the slabs' first cells. The root is below 0
/// where most normals point inward.
CoarseTree make_coarse_tree(PooledFlux flux, int top, int slab_count);

/// Sets what Slabs needs for kValues; returns the weight that was left out as that of outliers.
/// Throws Error(kCancelled).
double find_coarse_tree(const Progress& progress, int threads, Slabs* slabs);

/// Solves for the values of the tree; `middle` is that wanted at samples.
void solve_coarse_tree(float middle, CoarseTree* coarse);

}  // namespace prefilter
