// SPDX-License-Identifier: GPL-3.0-or-later

// Means of an image under the tents of its texels.
#pragma once

#include <vector>

#include "prefilter/base/image.h"
#include "prefilter/base/wrap.h"

namespace prefilter {

/// Replaces each texel by the mean of the interpolated image under its tent: its 3 x 3 neighborhood
/// with weights 1/6, 2/3, 1/6 along each axis. Texels with 0 in `read` have no weight and do not
/// change; an empty `read` stands for all. Texels beyond a border have no weight either.
Image tent_means(const ImageView& image, const std::vector<unsigned char>& read, WrapModes wrap,
                 int threads);

}  // namespace prefilter
