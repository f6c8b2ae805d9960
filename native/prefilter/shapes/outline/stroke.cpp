// SPDX-License-Identifier: GPL-3.0-or-later

// A stroke is the union of quadrilaterals along the curve, wedges at the outside of corners, and
// caps, all counter-clockwise. The sum of their boundaries runs along both sides, and through the
// corner itself on its inside. Winding numbers are never negative, so the non-zero rule yields the
// union.
#include "prefilter/shapes/stroke.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>
#include <string>
#include <utility>

#include "prefilter/base/error.h"
#include "prefilter/base/text.h"
#include "prefilter/shapes/outline/dashes.h"
#include "prefilter/shapes/outline/resolve_within_budget.h"
#include "prefilter/shapes/outline/stroke_pieces.h"
#include "prefilter/shapes/outline/stroke_sides.h"

namespace prefilter {
namespace {

constexpr int kMaxDashes = 1000000;
// Products of three coordinates below 2^300 do not overflow.
constexpr int kMaxExponent = 300;

void check(const StrokeOptions& options) {
  const auto check_length = [](double value, const char* name) {
    if (!(value >= 0.0) || !std::isfinite(value)) {
      throw_invalid(std::string(name) + ": " + to_text(value) + "; must be finite, and 0 or more");
    }
  };
  check_length(options.width, "width");
  for (const double dash : options.dashes) check_length(dash, "dashes");
  if (!std::isfinite(options.dash_offset)) {
    throw_invalid("dash_offset: " + to_text(options.dash_offset) + "; must be finite");
  }
  if (!(options.miter_limit >= 1.0)) {
    throw_invalid("miter_limit: " + to_text(options.miter_limit) + "; must be 1 or more");
  }
}

StrokePath path_of(const Outline& outline, std::size_t contour) {
  StrokePath path;
  path.is_closed = outline.is_closed(contour);
  path.point = outline.begin_of(contour);
  for (const Outline::Segment& segment : outline.contour(contour)) {
    const Curve curve = curve_of(outline, segment);
    const bool is_point = std::all_of(curve.controls.begin(), curve.controls.end(),
                                      [&](const Point2& p) { return p == curve.begin(); });
    if (!is_point) path.curves.emplace_back(curve, 0.0, 1.0);
  }
  return path;
}

// Appends the segments of a side, as a new contour if `begins`.
void append_side(const Outline& side, bool reversed, bool begins, Outline* outline) {
  const auto segments = side.segments();
  if (begins) outline->move_to(reversed ? side.points().back() : side.points().front());
  for (std::size_t i = 0; i < segments.size(); ++i) {
    const Outline::Segment& segment = segments[reversed ? segments.size() - 1 - i : i];
    const Curve curve = curve_of(side, segment);
    append_curve(curve, reversed, reversed ? curve.begin() : curve.end(), outline);
  }
}

// Appends the stroke along pieces.
void append_stroke(std::span<const StrokePiece> pieces, bool is_closed,
                   const StrokeOptions& options, double tolerance, Outline* outline) {
  const double half_width = 0.5 * options.width;
  const auto side = [&](double offset) {
    return stroke_side(pieces, is_closed, offset, options.join, options.miter_limit, tolerance);
  };
  append_side(side(-half_width), false, true, outline);
  if (is_closed) {
    outline->close();
    append_side(side(half_width), true, true, outline);
  } else {
    const StrokePiece& last = pieces.back();
    append_cap(last.end, last.end_normal, half_width, options.cap, outline);
    append_side(side(half_width), true, false, outline);
    const StrokePiece& first = pieces.front();
    append_cap(first.begin, -1.0 * first.begin_normal, half_width, options.cap, outline);
  }
  outline->close();
}

// Appends the caps of a path without length.
void append_dot(const StrokePath& path, const StrokeOptions& options, Outline* outline) {
  if (options.cap == StrokeCap::kButt) return;
  const double half_width = 0.5 * options.width;
  const Point2 normal = {-path.direction.y, path.direction.x};
  outline->move_to(path.point - half_width * normal);
  append_cap(path.point, normal, half_width, options.cap, outline);
  append_cap(path.point, -1.0 * normal, half_width, options.cap, outline);
  outline->close();
}

// The dashes of a path, or the path itself if it is solid.
std::vector<StrokePath> dashes_of(StrokePath path, std::span<const double> pattern, double period,
                                  double offset) {
  std::vector<StrokePath> paths;
  if (!(period > 0.0) || !std::isfinite(period) || path.curves.empty()) {
    paths.push_back(std::move(path));
    return paths;
  }
  double path_length = 0.0;
  for (const PartOfCurve& part : path.curves) path_length += arc_length(part.curve(), 0.0, 1.0);
  if (path_length / period * static_cast<double>(pattern.size() / 2) > kMaxDashes) {
    throw_invalid("dashes: more than " + std::to_string(kMaxDashes) + " on one contour");
  }
  append_dashes(path, pattern, offset, &paths);
  return paths;
}

}  // namespace

namespace {

// The largest coordinate or width; 0 if that is not finite.
double largest_magnitude(const Outline& outline, const StrokeOptions& options) {
  const Box2 box = control_box(outline);
  const double magnitude = std::max({std::fabs(box.low.x), std::fabs(box.low.y),
                                     std::fabs(box.high.x), std::fabs(box.high.y), options.width});
  return std::isfinite(magnitude) ? magnitude : 0.0;
}

// Curves cannot be approximated more closely than their coordinates are rounded.
double reachable_tolerance(double tolerance, const Outline& outline, const StrokeOptions& options) {
  return std::max(tolerance, kMinRelativeStrokeTolerance * largest_magnitude(outline, options));
}

// A power of 2 that makes all coordinates small enough; 1 if they are.
double shrink_factor(const Outline& outline, const StrokeOptions& options) {
  const double largest = largest_magnitude(outline, options);
  return largest > 0.0 ? std::ldexp(1.0, std::min(0, kMaxExponent - std::ilogb(largest))) : 1.0;
}

Outline scaled(const Outline& outline, double scale) {
  return outline.transformed({{scale, 0.0}, {0.0, scale}, {0.0, 0.0}});
}

StrokeOptions scaled(StrokeOptions options, double scale) {
  options.width *= scale;
  options.dash_offset *= scale;
  for (double& dash : options.dashes) dash *= scale;
  return options;
}

// The stroke's overlapping parts, whose winding numbers are never negative.
Outline overlapping_stroke(const Outline& outline, const StrokeOptions& options, double tolerance) {
  Outline covered;
  if (options.width == 0.0) return covered;
  tolerance = reachable_tolerance(tolerance, outline, options);
  std::vector<double> pattern = options.dashes;
  if (pattern.size() % 2 != 0) pattern.insert(pattern.end(), pattern.begin(), pattern.end());
  const double period = std::accumulate(pattern.begin(), pattern.end(), 0.0);
  double offset = period > 0.0 ? std::fmod(options.dash_offset, period) : 0.0;
  if (offset < 0.0) offset += period;

  for (std::size_t c = 0; c < outline.contour_count(); ++c) {
    if (outline.contour(c).empty() && !outline.is_closed(c)) continue;
    for (const StrokePath& path : dashes_of(path_of(outline, c), pattern, period, offset)) {
      const auto pieces = stroke_pieces(path, 0.5 * options.width, tolerance);
      if (pieces.empty()) {
        append_dot(path, options, &covered);
      } else {
        append_stroke(pieces, path.is_closed, options, tolerance, &covered);
      }
    }
  }
  return covered;
}

}  // namespace

Outline stroke(const Outline& outline, const StrokeOptions& options, double tolerance) {
  check(options);
  if (const double scale = shrink_factor(outline, options); scale < 1.0) {
    const Outline small = scaled(outline, scale);
    return scaled(stroke(small, scaled(options, scale), scale * tolerance), 1.0 / scale);
  }
  return resolve(overlapping_stroke(outline, options, tolerance), FillRule::kNonzero, tolerance);
}

Outline stroke_within_budget(const Outline& outline, const StrokeOptions& options, double tolerance,
                             bool* winds_once) {
  check(options);
  if (const double scale = shrink_factor(outline, options); scale < 1.0) {
    const StrokeOptions small = scaled(options, scale);
    const Outline outline_part =
        stroke_within_budget(scaled(outline, scale), small, scale * tolerance, winds_once);
    return scaled(outline_part, 1.0 / scale);
  }
  Outline covered = overlapping_stroke(outline, options, tolerance);
  std::optional<Outline> united;
  *winds_once = resolve_within_budget(covered, FillRule::kNonzero, {}, &united);
  return united ? std::move(*united) : covered;
}

}  // namespace prefilter
