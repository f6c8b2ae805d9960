// SPDX-License-Identifier: GPL-3.0-or-later

// How transparent a paint is at most, and how much its value changes over a pixel.
#pragma once

#include "prefilter/shapes/paint.h"

namespace prefilter {

/// More periods of a gradient across a shape than this are finer than what any image shows of them.
inline constexpr double kMostPeriods = 2048.0;

/// Whether a gradient has no value outside of a cone: it is between two circles, neither of which
/// holds the other.
bool is_cone(const Paint& paint);

/// The largest transmittance of a paint, 1 - alpha, over the whole plane.
double most_passing(const Paint& paint, int channels);

/// How much the offset of a gradient changes along a pixel's side at most; infinite for cones.
double offset_per_pixel(const Paint& paint);

/// Whether stops of a gradient between two circles are so close that pixels are not cut along their
/// circles: GradientMeans says what pixels show, in as much time however close stops are.
bool has_fine_stops(const Paint& paint);

/// Whether the value of a gradient jumps at an offset.
bool has_jumps(const Paint& paint);

/// Bounds on the difference of a value between opposite corners of a pixel, jumps at stops left
/// out.
struct PaintVariation {
  double value = 0.0;  // of any channel
  double alpha = 0.0;
};
PaintVariation variation_per_pixel(const Paint& paint);

}  // namespace prefilter
