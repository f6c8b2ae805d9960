// SPDX-License-Identifier: GPL-3.0-or-later

// Separable filters along x and y.
#pragma once

#include <vector>

#include "prefilter/base/image.h"
#include "prefilter/base/run.h"
#include "prefilter/base/wrap.h"
#include "prefilter/images/kernel.h"

namespace prefilter {

/// The taps of each target texel along an axis, with nondecreasing first source texels; empty if
/// the axis is not filtered.
using AxisTaps = std::vector<Taps>;

/// The taps of a kernel; empty for equal sizes.
AxisTaps resampling_taps(const Kernel& kernel, int source_size, int target_size);

/// Filters an image: texel (i, j) of the result is the sum over the taps of i along x and of j
/// along y. The wrap mode defines the values of taps outside the source.
Image filter_separably(const ImageView& source, const AxisTaps& along_x, const AxisTaps& along_y,
                       WrapModes wrap, const Run& run);

/// Resizes an image to width x height texels, each the kernel-weighted mean of the source around
/// it. An axis whose size does not change is not filtered. The wrap mode defines the texels outside
/// the source.
Image filter_separably(const ImageView& source, int width, int height, const Kernel& kernel,
                       WrapModes wrap, const Run& run);

}  // namespace prefilter
