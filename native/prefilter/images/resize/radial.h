// SPDX-License-Identifier: GPL-3.0-or-later

// Resizing by a filter of the distance.
#pragma once

#include "prefilter/base/image.h"
#include "prefilter/base/progress.h"
#include "prefilter/base/wrap.h"

namespace prefilter {

/// The image with width x height texels, each the mean of the texels around it, weighted by
/// WindowedJinc of their distance in units of the wider ones of old and new texels along each axis.
Image filter_radially(const ImageView& source, int width, int height, int radius, WrapModes wrap,
                      const Progress& progress, int threads);

}  // namespace prefilter
