// Downsampling by whole factors with a separable kernel.
#pragma once

#include "prefilter/base/image.h"
#include "prefilter/base/progress.h"
#include "prefilter/base/wrap.h"
#include "prefilter/filters/kernel.h"

namespace prefilter {

/// The image of width / factor_x by height / factor_y texels, each the kernel-weighted mean of the
/// source around it. What lies outside of the source is as the wrap mode says. The factors divide
/// the sides.
Image downsample(const ImageView& source, int factor_x, int factor_y, Kernel kernel, WrapModes wrap,
                 const Progress& progress, int threads);

}  // namespace prefilter
