// SPDX-License-Identifier: GPL-3.0-or-later

// The share of a surface that passes an alpha test.
#pragma once

#include "prefilter/base/image.h"
#include "prefilter/base/run.h"
#include "prefilter/base/wrap.h"

namespace prefilter {

/// The share, in [0, 1], of the surface where a bilinear lookup of `alpha` is at least the
/// threshold.
///
/// `weights` is a grid of any size over the unit square: each cell has the area of the surface in
/// it, in any unit, assumed to be spread uniformly over the cell. Lookups are at the centers of
/// `samples` x `samples` parts of every nonempty cell. Non-finite alpha counts as 0. Throws Error
/// if an image does not have one channel, `samples` is less than 1, or no weight is positive; and,
/// from the progress callback, when cancelled.
double covered_share(const ImageView& alpha, const ImageView& weights, int samples, float threshold,
                     WrapModes wrap, const Run& run);

}  // namespace prefilter
