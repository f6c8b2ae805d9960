// SPDX-License-Identifier: GPL-3.0-or-later

// Resolves overlapping contours to the boundary of the filled region.
#pragma once

#include <optional>

#include "prefilter/base/outline.h"
#include "prefilter/base/run.h"

namespace prefilter {

/// Largest error when curves have to be replaced by lines, in pixels.
inline constexpr double kOutlineTolerance = 1e-3;

/// The boundary of the region that a fill rule fills: closed contours that cross neither each other
/// nor themselves, with the inside on the left. Winding numbers are 1 inside and 0 outside.
///
/// Curves are preserved: a contour that meets no other contour is copied, reversed or dropped, as
/// the rule requires, and contours that cross are cut at their intersections. Only if rounding
/// makes the intersections ambiguous, all curves are replaced by lines, with an error of at most
/// `tolerance` > 0, in the outline's units. Coordinates must be finite.
Outline resolve(const Outline& outline, FillRule rule, double tolerance = kOutlineTolerance);

/// The result of `resolve`, or nothing if the outline is already resolved. Open contours count as
/// closed, and contours without extent are ignored.
std::optional<Outline> resolved(const Outline& outline, FillRule rule,
                                double tolerance = kOutlineTolerance, const Run& run = {});

}  // namespace prefilter
