// SPDX-License-Identifier: GPL-3.0-or-later

// What can be filtered.
#pragma once

#include <cmath>

#include "prefilter/base/image.h"
#include "prefilter/base/progress.h"

namespace prefilter {

/// Throws Error unless the image, called `name`, has 1 to 4 channels.
void check_channels(const ImageView& image, const char* name = "image");

/// Weighted sums over whole images of values up to this large do not overflow.
inline constexpr float kLargestValue = 1e30F;

/// False for what is not a number, infinite or too large.
inline bool is_filterable(float value) { return std::abs(value) <= kLargestValue; }

/// True where every value of the image can be filtered.
bool all_filterable(const ImageView& image, const Progress& progress, int threads);

}  // namespace prefilter
