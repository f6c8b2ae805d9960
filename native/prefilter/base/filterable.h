// SPDX-License-Identifier: GPL-3.0-or-later

// Checks of images before filtering.
#pragma once

#include <cmath>

#include "prefilter/base/image.h"
#include "prefilter/base/run.h"

namespace prefilter {

/// Throws Error unless the image, called `name`, has 1 to 4 channels.
void check_channels(const ImageView& image, const char* name = "image");

/// Magnitude up to which weighted sums over whole images do not overflow.
inline constexpr float kLargestValue = 1e30F;

/// False for NaN, infinite and too large values.
inline bool is_filterable(float value) { return std::abs(value) <= kLargestValue; }

/// Whether all values of the image can be filtered.
bool all_filterable(const ImageView& image, const Run& run);

}  // namespace prefilter
