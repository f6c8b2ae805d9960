// SPDX-License-Identifier: GPL-3.0-or-later

// Filling holes of an image from what is around them.
#pragma once

#include <vector>

#include "prefilter/base/image.h"
#include "prefilter/base/progress.h"
#include "prefilter/base/wrap.h"

namespace prefilter {

/// Replaces the first `channels` channels of every texel of weight 0, out to the image's edge, by
/// push-pull (Gortler et al., "The Lumigraph", 1996, section 3.4): weighted means are pulled up a
/// pyramid, and each hole is pushed the coarser level's bilinear value. Texels of positive weight
/// keep theirs. Nothing is changed where no texel has weight. Values at holes are not read, and may
/// be anything. `weights` has one number, 0 or more, a texel.
void fill_holes(const std::vector<float>& weights, WrapModes wrap, int channels,
                const Progress& progress, int threads, Image* image);

}  // namespace prefilter
