// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/voxels/contour/edge_crossing.h"

#include <algorithm>
#include <cmath>

namespace prefilter {
namespace {

// Equation 5.6: the line enters through the bottom of the emptier cell and leaves through the side
// of the other.
double bottom_to_side(double a1, double a2) {
  const double root = std::sqrt(a1 * (a1 + a2));
  return 1.0 - (2.0 * a2 - 1.0) / (8.0 * a1 + 4.0 * a2 - 8.0 * root);
}

bool is_bottom_to_side(double a1, double a2) {
  const double excess = 2.0 * a1 + 2.0 * a2 - 1.0;
  return excess * excess < 4.0 * a1 * (a1 + a2);
}

// Crossing seen from the emptier cell, whose occupancy a1 is below 1/2.
double crossing_from_emptier(double a1, double a2) {
  const bool first_side = a2 <= 3.0 * a1;
  const bool second_side = 3.0 * a2 <= a1 + 2.0;
  if (first_side && second_side) return (a1 - 0.5) / (a1 - a2);  // 5.2: side to side
  if (first_side != second_side) {
    if (!first_side && is_bottom_to_side(a1, a2)) return bottom_to_side(a1, a2);
    // Equation 5.8 is 5.6 applied to the outside, seen from the other end.
    if (!second_side && is_bottom_to_side(1.0 - a2, 1.0 - a1)) {
      return 1.0 - bottom_to_side(1.0 - a2, 1.0 - a1);
    }
  }
  return 1.5 - a1 - a2;  // 5.4: bottom to top
}
}  // namespace

float linear_crossing(float a, float b, float isovalue) { return (isovalue - a) / (b - a); }

float occupancy_crossing(float a, float b) {
  const double t =
      a < b ? crossing_from_emptier(static_cast<double>(a), static_cast<double>(b))
            : 1.0 - crossing_from_emptier(static_cast<double>(b), static_cast<double>(a));
  return static_cast<float>(std::clamp(t, 0.0, 1.0));
}

}  // namespace prefilter
