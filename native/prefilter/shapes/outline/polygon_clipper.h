// SPDX-License-Identifier: GPL-3.0-or-later

// Set operations of polygons on an integer grid, by the library Clipper2: what is left for outlines
// whose curves meet in ways that rounding decides.
#pragma once

#include <vector>

#include "prefilter/base/outline.h"
#include "prefilter/shapes/set_operations.h"

namespace prefilter {

/// A contour's vertices; a line closes it.
using Polygon = std::vector<Point2>;

/// The contours of an outline as polygons within `tolerance` of them.
std::vector<Polygon> flattened(const Outline& outline, double tolerance);

/// The boundary of a set operation of what the fill rules fill: contours that cross nowhere, the
/// inside on the left. Vertices are rounded to 2^-40 of the size of both.
Outline combine_polygons(const std::vector<Polygon>& first, FillRule first_rule,
                         const std::vector<Polygon>& second, FillRule second_rule,
                         OutlineOperation operation);

}  // namespace prefilter
