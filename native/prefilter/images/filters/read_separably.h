// SPDX-License-Identifier: GPL-3.0-or-later

// Filtering bytes along x and along y.
#pragma once

#include "prefilter/images/filters/filtered_image.h"
#include "prefilter/images/filters/separable.h"

namespace prefilter {

/// Whether no row of the result takes so much of the image that a cancel would wait for it.
bool reads_few_rows(const TexelSource& image, int width, int height, const Kernel& kernel);

/// What filter_separably makes of an image of bytes that is read by rows, to within a few
/// millionths: sums are of floats, as bytes do not tell the difference, and bytes become floats a
/// few rows at a time. Of images that `reads_few_rows` says yes to.
Image filter_bytes_separably(const FilteredImage& bytes, int width, int height,
                             const Kernel& kernel, WrapModes wrap, const Progress& progress,
                             int threads);

}  // namespace prefilter
