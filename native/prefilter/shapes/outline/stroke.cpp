// SPDX-License-Identifier: GPL-3.0-or-later

// A stroke is put together from quadrilaterals along the curve, wedges at the outside of corners
// and caps, all counter-clockwise: the sum of their boundaries runs along both sides, and through
// the corner itself on its inside. Winding numbers are nowhere negative, so the non-zero rule
// unites the pieces.
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
#include "prefilter/shapes/outline/resolve_soon.h"
#include "prefilter/shapes/outline/stroke_pieces.h"
#include "prefilter/shapes/outline/stroke_sides.h"

namespace prefilter {
namespace {

constexpr int kMostDashes = 1000000;
// The exponent of coordinates whose products, three and more, are finite still.
constexpr int kMostExponent = 300;

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

// Appends the segments of a side, and begins a contour with it if it `begins`.
void append_side(const Outline& side, bool reversed, bool begins, Outline* outline) {
  const auto segments = side.segments();
  if (begins) outline->move_to(reversed ? side.points().back() : side.points().front());
  for (std::size_t i = 0; i < segments.size(); ++i) {
    const Outline::Segment& segment = segments[reversed ? segments.size() - 1 - i : i];
    const Curve curve = curve_of(side, segment);
    append_curve(curve, reversed, reversed ? curve.begin() : curve.end(), outline);
  }
}

// What a pen covers along pieces.
void append_covered(std::span<const StrokePiece> pieces, bool is_closed,
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

// What it covers of a path of no length.
void append_dot(const StrokePath& path, const StrokeOptions& options, Outline* outline) {
  if (options.cap == StrokeCap::kButt) return;
  const double half_width = 0.5 * options.width;
  const Point2 normal = {-path.direction.y, path.direction.x};
  outline->move_to(path.point - half_width * normal);
  append_cap(path.point, normal, half_width, options.cap, outline);
  append_cap(path.point, -1.0 * normal, half_width, options.cap, outline);
  outline->close();
}

// What a pen goes along: a path, or its dashes.
std::vector<StrokePath> dashes_of(StrokePath path, std::span<const double> pattern, double period,
                                  double offset) {
  std::vector<StrokePath> paths;
  if (!(period > 0.0) || !std::isfinite(period) || path.curves.empty()) {
    paths.push_back(std::move(path));
    return paths;
  }
  double way = 0.0;
  for (const PartOfCurve& part : path.curves) way += arc_length(part.curve(), 0.0, 1.0);
  if (way / period * static_cast<double>(pattern.size() / 2) > kMostDashes) {
    throw_invalid("dashes: more than " + std::to_string(kMostDashes) + " on one contour");
  }
  append_dashes(path, pattern, offset, &paths);
  return paths;
}

}  // namespace

namespace {

// The largest coordinate or width; 0 where that is not finite.
double farthest(const Outline& outline, const StrokeOptions& options) {
  const Box2 box = control_box(outline);
  const double found = std::max({std::fabs(box.low.x), std::fabs(box.low.y), std::fabs(box.high.x),
                                 std::fabs(box.high.y), options.width});
  return std::isfinite(found) ? found : 0.0;
}

// Far from the origin no piece of a curve comes nearer to it than coordinates are rounded.
double reachable(double tolerance, const Outline& outline, const StrokeOptions& options) {
  return std::max(tolerance, kLeastStrokeTolerance * farthest(outline, options));
}

// The power of 2 that makes all coordinates small enough; else 1.
double shrinking(const Outline& outline, const StrokeOptions& options) {
  const double largest = farthest(outline, options);
  return largest > 0.0 ? std::ldexp(1.0, std::min(0, kMostExponent - std::ilogb(largest))) : 1.0;
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

// Its parts, of which winding numbers are nowhere negative.
Outline covered_by_parts(const Outline& outline, const StrokeOptions& options, double tolerance) {
  Outline covered;
  if (options.width == 0.0) return covered;
  tolerance = reachable(tolerance, outline, options);
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
        append_covered(pieces, path.is_closed, options, tolerance, &covered);
      }
    }
  }
  return covered;
}

}  // namespace

Outline stroke(const Outline& outline, const StrokeOptions& options, double tolerance) {
  check(options);
  if (const double scale = shrinking(outline, options); scale < 1.0) {
    const Outline small = scaled(outline, scale);
    return scaled(stroke(small, scaled(options, scale), scale * tolerance), 1.0 / scale);
  }
  return resolve(covered_by_parts(outline, options, tolerance), FillRule::kNonzero, tolerance);
}

Outline stroke_soon(const Outline& outline, const StrokeOptions& options, double tolerance,
                    bool* winds_once) {
  check(options);
  if (const double scale = shrinking(outline, options); scale < 1.0) {
    const StrokeOptions small = scaled(options, scale);
    const Outline made = stroke_soon(scaled(outline, scale), small, scale * tolerance, winds_once);
    return scaled(made, 1.0 / scale);
  }
  Outline covered = covered_by_parts(outline, options, tolerance);
  std::optional<Outline> united;
  *winds_once = resolve_soon(covered, FillRule::kNonzero, {}, &united);
  return united ? std::move(*united) : covered;
}

}  // namespace prefilter
