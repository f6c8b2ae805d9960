// SPDX-License-Identifier: GPL-3.0-or-later

// Splits shapes with linear gradients into strips of linear color.
#pragma once

#include <vector>

#include "prefilter/base/outline.h"
#include "prefilter/shapes/paint.h"

namespace prefilter {

/// The part of a shape between two stops.
struct GradientStrip {
  Outline outline;
  Paint paint;  // kConstant or kLinear
};

/// Cuts a shape painted with kLinearStops at its stops.
std::vector<GradientStrip> gradient_strips(const Outline& outline, const Paint& paint);

}  // namespace prefilter
