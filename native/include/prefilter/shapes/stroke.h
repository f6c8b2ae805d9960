// SPDX-License-Identifier: GPL-3.0-or-later

// Strokes along outlines, as outlines of their own.
#pragma once

#include <cstdint>
#include <vector>

#include "prefilter/base/names.h"
#include "prefilter/base/outline.h"
#include "prefilter/shapes/resolve.h"

namespace prefilter {

/// What fills the gap outside of a corner.
enum class StrokeJoin : std::uint8_t { kMiter, kRound, kBevel };

inline constexpr Named<StrokeJoin> kStrokeJoins[] = {
    {"miter", StrokeJoin::kMiter}, {"round", StrokeJoin::kRound}, {"bevel", StrokeJoin::kBevel}};

/// How open contours and dashes end: where they do, with half a disc, or with half a square.
enum class StrokeCap : std::uint8_t { kButt, kRound, kSquare };

inline constexpr Named<StrokeCap> kStrokeCaps[] = {
    {"butt", StrokeCap::kButt}, {"round", StrokeCap::kRound}, {"square", StrokeCap::kSquare}};

struct StrokeOptions {
  double width = 1.0;  // in the outline's units
  StrokeJoin join = StrokeJoin::kMiter;
  StrokeCap cap = StrokeCap::kButt;
  /// A miter longer than this, in widths, is cut off to a bevel; 1 or more.
  double miter_limit = 4.0;
  /// Lengths along the curve of dashes and gaps in turns, in the outline's units; none for a solid
  /// stroke. An odd number of them is gone through twice. Every contour begins anew.
  std::vector<double> dashes;
  /// How far into the dashes a contour begins.
  double dash_offset = 0.0;
};

/// What a pen of a width covers along the contours of an outline, as `resolve` would have it. A
/// contour of no length is covered by its caps alone, unless they are butt; one without segments
/// that was not closed is not drawn. Lines stay lines and round joins arcs; curves beside a curve
/// are within `tolerance` of where they should be.
///
/// Throws Error for a width, dash or offset that is not finite, or negative where it must not be;
/// for a miter limit below 1; for over a million dashes on a contour.
Outline stroke(const Outline& outline, const StrokeOptions& options,
               double tolerance = kOutlineTolerance);

/// The same, but where so much of it overlaps that it would take more steps than some for every
/// curve, the parts that it is put together from: they overlap, and by the non-zero rule fill the
/// same. Sets `winds_once` to whether they do not.
Outline stroke_soon(const Outline& outline, const StrokeOptions& options, double tolerance,
                    bool* winds_once);

}  // namespace prefilter
