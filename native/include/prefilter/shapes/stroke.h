// SPDX-License-Identifier: GPL-3.0-or-later

// Strokes of outlines.
#pragma once

#include <cstdint>
#include <vector>

#include "prefilter/base/names.h"
#include "prefilter/base/outline.h"
#include "prefilter/shapes/resolve.h"

namespace prefilter {

/// Fills the gap at the outside of a corner.
enum class StrokeJoin : std::uint8_t { kMiter, kRound, kBevel };

inline constexpr Named<StrokeJoin> kStrokeJoins[] = {
    {"miter", StrokeJoin::kMiter}, {"round", StrokeJoin::kRound}, {"bevel", StrokeJoin::kBevel}};

/// End of open contours and dashes: flush, with a half disc, or with half a square.
enum class StrokeCap : std::uint8_t { kButt, kRound, kSquare };

inline constexpr Named<StrokeCap> kStrokeCaps[] = {
    {"butt", StrokeCap::kButt}, {"round", StrokeCap::kRound}, {"square", StrokeCap::kSquare}};

struct StrokeOptions {
  double width = 1.0;  // in the outline's units
  StrokeJoin join = StrokeJoin::kMiter;
  StrokeCap cap = StrokeCap::kButt;
  /// Miters longer than this many widths become bevels; at least 1.
  double miter_limit = 4.0;
  /// Alternating lengths of dashes and gaps along the curve, in the outline's units; empty for a
  /// solid stroke. An odd number of them is repeated. Every contour restarts the pattern.
  std::vector<double> dashes;
  /// Position in the dash pattern at which a contour starts.
  double dash_offset = 0.0;
};

/// The region covered by a pen that follows the contours of an outline, in the form of `resolve`. A
/// contour of length 0 gets only its caps, unless they are butt; a contour without segments is
/// drawn only if it was closed. Lines stay lines and round joins become arcs; offsets of curves are
/// accurate to `tolerance`.
///
/// Throws Error for a width, dash or offset that is not finite or is negative where that is not
/// allowed, a miter limit below 1, and more than a million dashes on a contour.
Outline stroke(const Outline& outline, const StrokeOptions& options,
               double tolerance = kOutlineTolerance);

/// Strokes an outline. If overlaps cannot be resolved within a constant number of steps per curve,
/// returns the overlapping parts of the stroke, which the non-zero rule fills equally. Sets
/// `winds_once` to whether overlaps were resolved.
Outline stroke_within_budget(const Outline& outline, const StrokeOptions& options, double tolerance,
                             bool* winds_once);

}  // namespace prefilter
