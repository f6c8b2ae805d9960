// SPDX-License-Identifier: GPL-3.0-or-later

// Separable filtering of byte images.
#pragma once

#include "prefilter/images/filters/filtered_image.h"
#include "prefilter/images/filters/separable.h"

namespace prefilter {

/// Whether every row of the result reads a small enough part of the image for prompt cancellation.
bool reads_few_rows(const TexelSource& image, int width, int height, const Kernel& kernel);

/// Same result as filter_separably for an image of bytes read by rows, up to a few millionths. Sums
/// are floats, as bytes need no more precision, and only a few rows at a time are converted.
/// Requires `reads_few_rows`.
Image filter_bytes_separably(const FilteredImage& bytes, int width, int height,
                             const Kernel& kernel, WrapModes wrap, const Run& run);

}  // namespace prefilter
