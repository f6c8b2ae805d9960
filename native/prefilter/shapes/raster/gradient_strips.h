// SPDX-License-Identifier: GPL-3.0-or-later

// Gradients along a line, as shapes of linear color.
#pragma once

#include <vector>

#include "prefilter/base/outline.h"
#include "prefilter/shapes/paint.h"

namespace prefilter {

/// What lies between two stops.
struct GradientStrip {
  Outline outline;
  Paint paint;  // kConstant or kLinear
};

/// A shape painted by kLinearStops, cut at its stops.
std::vector<GradientStrip> gradient_strips(const Outline& outline, const Paint& paint);

}  // namespace prefilter
