// SPDX-License-Identifier: GPL-3.0-or-later

// Computes the sample data that all slabs share, before any slab's tree is built.
#pragma once

#include <vector>

#include "prefilter/base/run.h"
#include "prefilter/points/reconstruct/sample_slab.h"
#include "prefilter/points/reconstruct/slabs.h"

namespace prefilter {

/// Sets `whole`, `offsets` and `least_leaf` of Slabs, the inputs of kLeaves and kCoefficients.
/// Returns the slab with the most cells. Throws Error(kCancelled).
int compute_whole_samples(std::size_t attribute_count, const Run& run, Slabs* slabs);

/// Adds the weight of a slab's samples to that of the depth at which they count, the largest at
/// which the surface crosses their cell. Samples that count above the slab's first level are
/// assigned to that level.
void weigh_leaves(const SampleSlab& slab, std::vector<double>* weights);

/// Samples that count at smaller depths than this are much sparser than most: one less than the
/// median depth by weight.
int least_leaf_depth(const std::vector<double>& weights);

}  // namespace prefilter
