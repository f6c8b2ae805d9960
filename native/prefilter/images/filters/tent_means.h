// SPDX-License-Identifier: GPL-3.0-or-later

// Means of an image under the tents of its own texels.
#pragma once

#include <vector>

#include "prefilter/base/image.h"
#include "prefilter/base/wrap.h"

namespace prefilter {

/// Each texel becomes the mean of the interpolated image under its tent: of it and its eight
/// neighbors, 2/3 and 1/6 along each axis. Texels that are not `read` (0) do not count, and stay
/// as they are; an empty `read` stands for all. Neither does what lies beyond a border.
Image tent_means(const ImageView& image, const std::vector<unsigned char>& read, WrapModes wrap,
                 int threads);

}  // namespace prefilter
