// SPDX-License-Identifier: GPL-3.0-or-later

// How much of a surface an alpha test keeps.
#pragma once

#include "prefilter/base/image.h"
#include "prefilter/base/progress.h"
#include "prefilter/base/wrap.h"

namespace prefilter {

/// The share, in [0, 1], of the surface where a bilinear lookup of `alpha` gives at least the
/// threshold.
///
/// `weights` is a grid over the unit square, of any size: each cell holds the surface's area in it,
/// in any unit, taken to be spread evenly over the cell. Lookups are made at the centers of
/// `samples` x `samples` parts of every cell that holds some. Values of alpha that are not finite
/// count as 0. Throws Error where an image has not one channel, `samples` is less than 1, or no
/// weight is positive; and, from the progress callback, when cancelled.
double covered_share(const ImageView& alpha, const ImageView& weights, int samples, float threshold,
                     WrapModes wrap, const Progress& progress, int threads);

}  // namespace prefilter
