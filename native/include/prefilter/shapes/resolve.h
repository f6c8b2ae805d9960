// SPDX-License-Identifier: GPL-3.0-or-later

// Outlines whose contours overlap, made into the boundary of what they fill.
#pragma once

#include <optional>

#include "prefilter/base/outline.h"
#include "prefilter/base/progress.h"

namespace prefilter {

/// How far curves may be off where they have to be replaced by lines, in pixels.
inline constexpr double kOutlineTolerance = 1e-3;

/// The boundary of what a fill rule fills: closed contours that cross neither each other nor
/// themselves, with the inside on the left. Every point inside has the winding number 1, every
/// point outside 0.
///
/// Curves stay the same curves: a contour that meets no other one is kept as it is, control point
/// by control point, reversed, or left out, as the rule says, and those that cross are cut where
/// they do. Only where rounding leaves no way to tell what crosses what, all curves are replaced by
/// lines, off by `tolerance` at the most. That is above 0, in the outline's units. Coordinates must
/// be finite.
Outline resolve(const Outline& outline, FillRule rule, double tolerance = kOutlineTolerance);

/// The same, but nothing where that would be the outline itself: it is resolved as it is, but for
/// open contours, which are filled as if they were closed, and contours that are points.
std::optional<Outline> resolved(const Outline& outline, FillRule rule,
                                double tolerance = kOutlineTolerance,
                                const Progress& progress = {});

}  // namespace prefilter
