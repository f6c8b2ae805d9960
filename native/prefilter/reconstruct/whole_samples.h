// SPDX-License-Identifier: GPL-3.0-or-later

// What is known of all slabs together before any of them is made into a tree.
#pragma once

#include <vector>

#include "prefilter/base/progress.h"
#include "prefilter/reconstruct/sample_slab.h"
#include "prefilter/reconstruct/slabs.h"

namespace prefilter {

/// Sets what Slabs needs for kLeaves and kCoefficients: `whole` and `offsets`. Returns the
/// slab that has most cells. Throws Error(kCancelled).
int find_whole(std::size_t attribute_count, const Progress& progress, int threads, Slabs* slabs);

}  // namespace prefilter
