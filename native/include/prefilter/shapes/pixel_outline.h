// SPDX-License-Identifier: GPL-3.0-or-later

// Outlines of sets of pixels.
#pragma once

#include "prefilter/base/outline.h"

namespace prefilter {

/// Pixels with coordinates above this in magnitude are left out.
inline constexpr int kMaxOutlinePixel = 1 << 17;

/// The outline of all pixels whose centers are inside an outline; it winds once around them. A
/// center on the boundary counts if the inside is to its right or, with y pointing up, below it.
/// Throws Error for coordinates that are not finite, or above 1e9 in magnitude.
Outline pixel_outline(const Outline& outline, FillRule rule);

}  // namespace prefilter
