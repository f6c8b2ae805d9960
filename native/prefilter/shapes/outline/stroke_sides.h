// SPDX-License-Identifier: GPL-3.0-or-later

// The boundary of a stroke: two sides, and caps.
#pragma once

#include <span>

#include "prefilter/base/outline.h"
#include "prefilter/shapes/outline/stroke_pieces.h"
#include "prefilter/shapes/stroke.h"

namespace prefilter {

/// One side of a path at `offset` to its left, with the joins around the outside of corners: an
/// outline of one open contour. On the inside of a corner the side passes through the corner
/// itself, unless the offsets of two lines intersect before. Pieces that are collinear within
/// `tolerance` have no corner between them.
Outline stroke_side(std::span<const StrokePiece> pieces, bool is_closed, double offset,
                    StrokeJoin join, double miter_limit, double tolerance);

/// Appends a cap from the right to the left side of a path that ends at `end`, where `normal`
/// points to its left.
void append_cap(const Point2& end, const Point2& normal, double half_width, StrokeCap cap,
                Outline* outline);

}  // namespace prefilter
