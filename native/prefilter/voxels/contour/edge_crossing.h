// SPDX-License-Identifier: GPL-3.0-or-later

// Where the surface cuts the line between the centers of two cells (section 5.2).
#pragma once

#include <cmath>
#include <limits>

namespace prefilter {

/// The sample that stands for what is empty: 0, or where that would be inside, the largest that is
/// not.
inline float empty_sample(float isovalue) {
  return isovalue > 0.0F ? 0.0F : std::nextafter(isovalue, -std::numeric_limits<float>::infinity());
}

/// Where between the samples a (t = 0) and b (t = 1), on two sides of the iso-value, a linear
/// function takes it.
float linear_crossing(float a, float b, float isovalue);

/// Where the line that divides two neighboring unit squares, so that shares a and b of them are
/// inside, cuts the line between their centers: t from 0 at the center of a to 1 at that of b.
/// Exact where there is such a line (equations 5.2, 5.4, 5.6 and 5.8, chosen as in 5.2.5). One of a
/// and b is below 1/2, the other is not, and both are in [0, 1].
float occupancy_crossing(float a, float b);

}  // namespace prefilter
