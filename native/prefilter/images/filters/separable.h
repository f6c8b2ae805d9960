// SPDX-License-Identifier: GPL-3.0-or-later

// Filtering along x and along y.
#pragma once

#include <vector>

#include "prefilter/base/image.h"
#include "prefilter/base/progress.h"
#include "prefilter/base/wrap.h"
#include "prefilter/images/kernel.h"

namespace prefilter {

/// The taps of each target texel along an axis, the first source texels in rising order; none where
/// the axis stays as it is.
using AxisTaps = std::vector<Taps>;

/// The taps of a kernel; none for sizes that are equal.
AxisTaps resampling_taps(const Kernel& kernel, int source_size, int target_size);

/// The image whose texel (i, j) is the sum, over the taps of i along x and of j along y, of what
/// the source has there. Taps outside of the source read what the wrap mode says.
Image filter_separably(const ImageView& source, const AxisTaps& along_x, const AxisTaps& along_y,
                       WrapModes wrap, const Progress& progress, int threads);

/// The image of width x height texels, each the kernel-weighted mean of the source around it. An
/// axis whose size stays is left alone. What lies outside of the source is as the wrap mode says.
Image filter_separably(const ImageView& source, int width, int height, const Kernel& kernel,
                       WrapModes wrap, const Progress& progress, int threads);

}  // namespace prefilter
