// Outlines whose contours overlap, made into the boundary of what they fill.
#pragma once

#include "prefilter/base/outline.h"

namespace prefilter {

/// How far curves may be off where they have to be replaced by lines, in pixels.
inline constexpr double kOutlineTolerance = 1e-3;

/// The boundary of what a fill rule fills: closed contours that cross neither each other nor
/// themselves, with the inside on the left. Every point inside has the winding number 1, every
/// point outside 0.
///
/// A contour that meets no other one is kept as it is, control point by control point, reversed, or
/// left out, as the rule says. Coordinates must be finite. `tolerance`, above 0, is in the
/// outline's units.
Outline resolve(const Outline& outline, FillRule rule, double tolerance = kOutlineTolerance);

}  // namespace prefilter
