// SPDX-License-Identifier: GPL-3.0-or-later

// Set operations of polygons on an integer grid, by the library Clipper2. The fallback for outlines
// whose intersections are ambiguous due to rounding.
#pragma once

#include <vector>

#include "prefilter/base/outline.h"
#include "prefilter/shapes/set_operations.h"

namespace prefilter {

/// Vertices of a contour that is closed by a line.
using Polygon = std::vector<Point2>;

/// The contours of an outline as polygons, accurate to `tolerance`.
std::vector<Polygon> flattened(const Outline& outline, double tolerance);

/// Boundary of a set operation: contours that do not cross, with the inside on the left. Vertices
/// are rounded to 2^-40 of the size of both operands.
Outline combine_polygons(const std::vector<Polygon>& first, FillRule first_rule,
                         const std::vector<Polygon>& second, FillRule second_rule,
                         OutlineOperation operation);

}  // namespace prefilter
