// Downsampling with a separable kernel.
#pragma once

#include "prefilter/base/image.h"
#include "prefilter/base/progress.h"
#include "prefilter/base/wrap.h"
#include "prefilter/filters/kernel.h"

namespace prefilter {

/// The image of width x height texels, no more than the source's, each the kernel-weighted mean of
/// the source around it. What lies outside of the source is as the wrap mode says.
Image downsample(const ImageView& source, int width, int height, const Kernel& kernel,
                 WrapModes wrap, const Progress& progress, int threads);

}  // namespace prefilter
