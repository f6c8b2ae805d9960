// SPDX-License-Identifier: GPL-3.0-or-later

// Fills holes of an image from their surroundings.
#pragma once

#include <vector>

#include "prefilter/base/image.h"
#include "prefilter/base/run.h"
#include "prefilter/base/wrap.h"

namespace prefilter {

/// Replaces the first `channels` channels of every texel of weight 0, out to the image's edge, by
/// push-pull (Gortler et al., "The Lumigraph", 1996, section 3.4): pulls weighted means up a
/// pyramid, then pushes the coarser level's bilinear interpolation into the holes. Texels with a
/// positive weight do not change, and nothing does if there are none. Values in holes are not read.
/// `weights` holds one nonnegative number per texel.
void fill_holes(const std::vector<float>& weights, WrapModes wrap, int channels, const Run& run,
                Image* image);

}  // namespace prefilter
