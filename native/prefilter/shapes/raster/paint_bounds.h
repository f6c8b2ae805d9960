// SPDX-License-Identifier: GPL-3.0-or-later

// Bounds on the transparency of a paint and on its variation over a pixel.
#pragma once

#include "prefilter/shapes/paint.h"

namespace prefilter {

/// A gradient with more periods than this across a shape is too fine to be resolved.
inline constexpr double kMaxPeriods = 2048.0;

/// Whether a radial gradient is undefined outside a cone: neither of its circles contains the
/// other.
bool is_cone(const Paint& paint);

/// Largest transmittance, 1 - alpha, of a paint over the whole plane.
double max_transmittance(const Paint& paint, int channels);

/// Largest change of a gradient's offset along a pixel's side; infinite for cones.
double offset_per_pixel(const Paint& paint);

/// Whether the stops of a radial gradient are so dense that pixels are not cut along its circles.
/// GradientMeans averages such gradients in a time independent of their density.
bool has_fine_stops(const Paint& paint);

/// Whether the value of a gradient jumps at an offset.
bool has_jumps(const Paint& paint);

/// Bounds on the difference of a value between opposite corners of a pixel, ignoring jumps at
/// stops.
struct PaintVariation {
  double value = 0.0;  // the largest over all channels
  double alpha = 0.0;
};
PaintVariation variation_per_pixel(const Paint& paint);

}  // namespace prefilter
