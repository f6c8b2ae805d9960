// SPDX-License-Identifier: GPL-3.0-or-later

// Texels of a texture that a surface uses.
#pragma once

#include <vector>

#include "prefilter/base/image.h"
#include "prefilter/base/run.h"
#include "prefilter/base/wrap.h"
#include "prefilter/geometry/surface.h"

namespace prefilter {

/// For each texel of a width x height image: the share of the surfaces' area in it, in one channel,
/// scaled so that a uniform use of the whole image gives 1. Exactly 0 in texels without surface.
/// Throws Error if a side is less than 1, if there is no surface, or if none has an area inside the
/// image.
Image texel_weights(const std::vector<const Surface*>& surfaces, int width, int height,
                    WrapModes wrap, const Run& run);

/// Fills the colors of texels with an alpha of 0 or less (alpha is the last of 2 to 4 channels)
/// from their surroundings, by push-pull weighted with alpha. Throws Error for other channel
/// counts.
Image fill_transparent(const ImageView& image, WrapModes wrap, const Run& run);

/// Fills texels that no bilinear lookup on the surfaces reads from the read ones around them, by
/// push-pull, out to the edges of the image. Throws Error like texel_weights.
Image fill_unused(const ImageView& image, const std::vector<const Surface*>& surfaces,
                  WrapModes wrap, const Run& run);

}  // namespace prefilter
