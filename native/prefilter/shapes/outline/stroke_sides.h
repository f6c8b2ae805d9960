// SPDX-License-Identifier: GPL-3.0-or-later

// What bounds a stroke: its two sides, and caps.
#pragma once

#include <span>

#include "prefilter/base/outline.h"
#include "prefilter/shapes/outline/stroke_pieces.h"
#include "prefilter/shapes/stroke.h"

namespace prefilter {

/// One side of a way, `offset` to its left, with what goes around the outside of corners: an open
/// contour, of an outline that has no other. On the inside of a corner it goes through the corner
/// itself, unless the sides of two lines meet before. Pieces that are as good as one line within
/// `tolerance` have no corner between them.
Outline stroke_side(std::span<const StrokePiece> pieces, bool is_closed, double offset,
                    StrokeJoin join, double miter_limit, double tolerance);

/// Goes on from the right to the left of a way that ends at `end`, where `normal` points to its
/// left.
void append_cap(const Point2& end, const Point2& normal, double half_width, StrokeCap cap,
                Outline* outline);

}  // namespace prefilter
