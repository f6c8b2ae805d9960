// SPDX-License-Identifier: GPL-3.0-or-later

// The ellipse of texels that a pixel covers.
#pragma once

#include "prefilter/sampling/sample_places.h"

namespace prefilter {

/// What the unit of a filter becomes: an ellipse, by its two widths in texels of level 0, and the
/// direction (x, y) of the wider one, of length 1.
struct Footprint {
  double major = 1.0;
  double minor = 1.0;
  double direction_x = 1.0;
  double direction_y = 0.0;
};

/// The singular values of a Jacobian, whose values are finite, and its direction. Those that are a
/// power of two but for rounding are that power.
Footprint singular_values(const TextureJacobian& jacobian);

/// The larger one of them.
double larger_singular_value(const TextureJacobian& jacobian);

/// singular_values with widths of at least 1, and at most that of a texel of level `last_level`: no
/// filter is narrower than a texel, and none wider than those of the coarsest level.
Footprint footprint_of(const TextureJacobian& jacobian, int last_level);

}  // namespace prefilter
