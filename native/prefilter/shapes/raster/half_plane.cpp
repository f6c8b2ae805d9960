// SPDX-License-Identifier: GPL-3.0-or-later

// Clips each segment at its roots of the linear function, as Sutherland and Hodgman's algorithm
// clips polygons.
#include "prefilter/shapes/half_plane.h"

#include <array>
#include <cmath>
#include <vector>

#include "prefilter/base/curve.h"
#include "prefilter/geometry/moments/monotone_curve.h"

namespace prefilter {
namespace {

struct HalfPlaneInterval {
  double from;
  double to;
};

// Finds the parameter intervals of a segment in which the function is at least 0.
void find_inside(std::span<const Point2> controls, double weight, const LinearFunction& function,
                 std::vector<HalfPlaneInterval>* inside) {
  inside->clear();
  bool is_inside = true;
  std::array<Point2, Outline::kMostDegree + 1> values;  // of the function, in x
  for (std::size_t i = 0; i < controls.size(); ++i) {
    values[i] = {function(controls[i]), 0.0};
    is_inside = is_inside && values[i].x >= 0.0;
  }
  if (is_inside) {
    inside->push_back({0.0, 1.0});
    return;
  }
  const std::span<const Point2> all(values.data(), controls.size());
  MonotoneCurve piece;
  piece.curve = ParametricCurve(all, weight);
  piece.begin = all.front();
  std::array<double, kMostTurns> turns;
  const int count = turning_points(piece.curve, all, &turns);
  const auto add = [&](double from, double to) {
    if (!inside->empty() && inside->back().to == from) {
      inside->back().to = to;
    } else {
      inside->push_back({from, to});
    }
  };
  for (int i = 0; i <= count; ++i) {
    piece.t_end = i < count ? turns[i] : 1.0;
    piece.end = i < count ? piece.curve.at(turns[i]) : all.back();
    const bool begins = piece.begin.x >= 0.0;
    const bool ends = piece.end.x >= 0.0;
    if (begins && ends) {
      add(piece.t_begin, piece.t_end);
    } else if (begins || ends) {
      const double t = crossing(piece, 0, 0.0, piece.t_begin);
      if (begins) {
        add(piece.t_begin, t);
      } else {
        add(t, piece.t_end);
      }
    }
    piece.t_begin = piece.t_end;
    piece.begin = piece.end;
  }
}

// The part of an outline where the function is at least 0.
Outline clip(const Outline& outline, const LinearFunction& function) {
  Outline clipped;
  std::vector<HalfPlaneInterval> inside;
  for (std::size_t contour = 0; contour < outline.contour_count(); ++contour) {
    bool has_begun = false;
    Point2 last;
    const auto add_segment = [&](std::span<const Point2> controls, double weight) {
      find_inside(controls, weight, function, &inside);
      for (const HalfPlaneInterval& interval : inside) {
        const PartOfCurve part({controls, weight}, interval.from, interval.to);
        const std::span<const Point2> points = part.curve().controls;
        if (!has_begun) {
          clipped.move_to(points.front());
          has_begun = true;
        } else if (!(last == points.front())) {
          clipped.line_to(points.front());
        }
        if (part.curve().weight == 0.0) {
          clipped.curve_to(points.subspan(1));
        } else {
          clipped.conic_to(points[1], part.curve().weight, points[2]);
        }
        last = points.back();
      }
    };
    const auto segments = outline.contour(contour);
    if (segments.empty()) continue;
    for (const Outline::Segment& segment : segments) {
      add_segment(outline.controls(segment), segment.weight);
    }
    const std::array<Point2, 2> closing = {outline.controls(segments.back()).back(),
                                           outline.begin_of(contour)};
    if (!(closing[0] == closing[1])) add_segment(closing, 0.0);
    if (has_begun) clipped.close();
  }
  return clipped;
}

}  // namespace

Outline clip_between(const Outline& outline, const LinearFunction& function, double low,
                     double high) {
  double least = HUGE_VAL;
  double most = -HUGE_VAL;
  for (const Point2& point : outline.points()) {
    least = std::min(least, function(point));
    most = std::max(most, function(point));
  }
  Outline result = outline;
  if (least < low) result = clip(result, {function.slope, function.constant - low});
  if (most > high) result = clip(result, {-1.0 * function.slope, high - function.constant});
  return result;
}

}  // namespace prefilter
