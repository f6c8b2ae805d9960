// SPDX-License-Identifier: GPL-3.0-or-later

// What a surface uses of its texture, texel by texel.
#pragma once

#include <vector>

#include "prefilter/base/image.h"
#include "prefilter/base/progress.h"
#include "prefilter/base/wrap.h"
#include "prefilter/geometry/surface.h"

namespace prefilter {

/// The share of the surfaces' area that lies in each texel of a width x height image, one channel,
/// scaled so that an even use of the whole image gives 1. Exactly 0 where no area is. Throws Error
/// where a side is less than 1, there is no surface, or none of it has an area or lies inside of
/// the image.
Image texel_weights(const std::vector<const Surface*>& surfaces, int width, int height,
                    WrapModes wrap, const Progress& progress, int threads);

/// The image with the colors of texels whose alpha, the last of 2 to 4 channels, is 0 or less
/// filled from what is around (push-pull), weighted by alpha. Throws Error for other channels.
Image fill_transparent(const ImageView& image, WrapModes wrap, const Progress& progress,
                       int threads);

/// The image with the texels that no bilinear lookup on the surfaces reads filled from what is
/// around those that some does (push-pull), out to the image's edge. Throws Error as texel_weights.
Image fill_unused(const ImageView& image, const std::vector<const Surface*>& surfaces,
                  WrapModes wrap, const Progress& progress, int threads);

}  // namespace prefilter
