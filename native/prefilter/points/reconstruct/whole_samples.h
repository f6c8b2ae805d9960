// SPDX-License-Identifier: GPL-3.0-or-later

// What is known of all slabs together before any of them is made into a tree.
#pragma once

#include <vector>

#include "prefilter/base/progress.h"
#include "prefilter/points/reconstruct/sample_slab.h"
#include "prefilter/points/reconstruct/slabs.h"

namespace prefilter {

/// Sets what Slabs needs for kLeaves and kCoefficients: `whole`, `offsets` and `least_leaf`.
/// Returns the slab that has most cells. Throws Error(kCancelled).
int find_whole(std::size_t attribute_count, const Progress& progress, int threads, Slabs* slabs);

/// Adds the weight of a slab's samples to that of the depth at which they count: the largest one at
/// which their cell is met. Those that count above the slab's first level are taken to count there.
void weigh_leaves(const SampleSlab& slab, std::vector<double>* weights);

/// Samples that count at smaller depths than this lie much thinner than most: one depth above the
/// one up to which half of the weight counts.
int least_leaf_depth(const std::vector<double>& weights);

}  // namespace prefilter
