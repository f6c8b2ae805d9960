// SPDX-License-Identifier: GPL-3.0-or-later

// The curves along which a gradient between two circles has a kink or a jump.
#pragma once

#include "prefilter/base/outline.h"
#include "prefilter/shapes/paint.h"

namespace prefilter {

/// The circles of the stops of a kRadialStops paint, where these are not fine, and the sides of its
/// cone, as far as they may pass a box; nothing for other paints. Between these curves the color is
/// smooth. Fill rules and orientation do not count.
Outline gradient_cutter(const Paint& paint, const Box2& box);

}  // namespace prefilter
