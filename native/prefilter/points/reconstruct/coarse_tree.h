// SPDX-License-Identifier: GPL-3.0-or-later

// Builds the tree levels above the slabs in the Haar basis.
#pragma once

#include <vector>

#include "prefilter/base/run.h"
#include "prefilter/points/reconstruct/assemble.h"
#include "prefilter/points/reconstruct/slabs.h"

namespace prefilter {

/// Turns the coefficients of all slabs, in the cells of depth `top` and above, into values.
/// `flux[k]` holds the samples' contributions at depth k, up to `top`, the depth of the slabs'
/// first cells. The root is below 0 where most normals point inward.
CoarseTree make_coarse_tree(PooledFlux flux, int top, int slab_count);

/// Sets the members that Slabs needs for kValues; returns the total weight of the outliers. Throws
/// Error(kCancelled).
double build_coarse_tree(const Run& run, Slabs* slabs);

/// Solves for the values of the coarse tree; `target` is the value wanted at samples.
void solve_coarse_tree(float target, CoarseTree* coarse);

}  // namespace prefilter
