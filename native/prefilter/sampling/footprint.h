// SPDX-License-Identifier: GPL-3.0-or-later

// The ellipse that a pixel covers in the image.
#pragma once

#include "prefilter/sampling/sample_places.h"

namespace prefilter {

/// The image of the filter's unit circle: an ellipse with its two widths, in texels of level 0, and
/// the unit direction (x, y) of its major axis.
struct Footprint {
  double major = 1.0;
  double minor = 1.0;
  double direction_x = 1.0;
  double direction_y = 0.0;
};

/// The singular values of a finite Jacobian, and the direction of the larger one. Values within
/// rounding of a power of two are set to it.
Footprint singular_values(const TextureJacobian& jacobian);

/// The larger singular value.
double larger_singular_value(const TextureJacobian& jacobian);

/// The singular values, clamped between 1 and the width of a texel of level `last_level`: no filter
/// is narrower than a texel, or wider than those of the coarsest level.
Footprint footprint_of(const TextureJacobian& jacobian, int last_level);

}  // namespace prefilter
