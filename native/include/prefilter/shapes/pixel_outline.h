// SPDX-License-Identifier: GPL-3.0-or-later

// Outlines along the sides of pixels.
#pragma once

#include "prefilter/base/outline.h"

namespace prefilter {

/// Pixels farther from 0 than this are left out.
inline constexpr int kMostCrispPixels = 1 << 17;

/// All pixels whose centers an outline fills, as an outline that winds once around them. A center
/// on its boundary counts where the filled part is to its right or, with y upwards, below it.
/// Throws Error where a coordinate is not finite, or farther than 1e9 pixels away.
Outline pixel_outline(const Outline& outline, FillRule rule);

}  // namespace prefilter
