// SPDX-License-Identifier: GPL-3.0-or-later

// Curves along which a radial gradient has a kink or a jump.
#pragma once

#include "prefilter/base/outline.h"
#include "prefilter/shapes/paint.h"

namespace prefilter {

/// The circles at the stops of a kRadialStops paint, unless its stops are fine, and the sides of
/// its cone, as far as they may cross a box. Empty for other paints. Between these curves the color
/// is smooth. The fill rule and orientation of the result have no meaning.
Outline gradient_cutter(const Paint& paint, const Box2& box);

}  // namespace prefilter
