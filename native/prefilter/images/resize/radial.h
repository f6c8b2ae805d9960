// SPDX-License-Identifier: GPL-3.0-or-later

// Resizes images with a radial filter.
#pragma once

#include "prefilter/base/image.h"
#include "prefilter/base/run.h"
#include "prefilter/base/wrap.h"

namespace prefilter {

/// Resizes an image to width x height texels, each the mean of the texels around it weighted by
/// WindowedJinc of their distance. The unit along each axis is the larger of source and target
/// texels.
Image filter_radially(const ImageView& source, int width, int height, int radius, WrapModes wrap,
                      const Run& run);

}  // namespace prefilter
