// SPDX-License-Identifier: GPL-3.0-or-later

// Intersection of the surface with the line between the centers of two cells (section 5.2).
#pragma once

#include <cmath>
#include <limits>

namespace prefilter {

/// The sample that represents empty space: 0, or if that would be inside, the largest value that is
/// not.
inline float empty_sample(float isovalue) {
  return isovalue > 0.0F ? 0.0F : std::nextafter(isovalue, -std::numeric_limits<float>::infinity());
}

/// Position of the iso-value between the samples a (t = 0) and b (t = 1) of a linear function; the
/// samples must lie on different sides of it.
float linear_crossing(float a, float b, float isovalue);

/// Two neighboring unit squares have shares a and b inside. Returns the position at which the line
/// that divides them so crosses the segment between their centers: t = 0 at the center of a, t = 1
/// at the center of b. Exact where such a line exists (equations 5.2, 5.4, 5.6 and 5.8, chosen as
/// in 5.2.5). Exactly one of a and b must be below 1/2, and both in [0, 1].
float occupancy_crossing(float a, float b);

}  // namespace prefilter
