// SPDX-License-Identifier: GPL-3.0-or-later

// Offset curves are approximated by cubics that interpolate their ends and end derivatives. Curves
// are halved until the error at three parameters is within the tolerance.
#include "prefilter/shapes/outline/stroke_pieces.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <utility>

namespace prefilter {
namespace {

constexpr int kMaxHalvings = 18;

Point2 unit(const Point2& p) { return (1.0 / length(p)) * p; }
Point2 left_of(const Point2& direction) { return {-direction.y, direction.x}; }

// Directions at the ends of a curve: toward the nearest control point that differs from the end.
Point2 begin_direction(std::span<const Point2> controls) {
  for (std::size_t i = 1; i < controls.size(); ++i) {
    if (!(controls[i] == controls[0])) return unit(controls[i] - controls[0]);
  }
  return {1.0, 0.0};
}
Point2 end_direction(std::span<const Point2> controls) {
  for (std::size_t i = controls.size() - 1; i > 0; --i) {
    if (!(controls[i - 1] == controls.back())) return unit(controls.back() - controls[i - 1]);
  }
  return {1.0, 0.0};
}

// Total turning of a control polygon, in radians.
double turning(std::span<const Point2> controls) {
  double sum = 0.0;
  Point2 last{};
  for (std::size_t i = 0; i + 1 < controls.size(); ++i) {
    const Point2 step = controls[i + 1] - controls[i];
    if (step == Point2{}) continue;
    if (!(last == Point2{}))
      sum += std::fabs(elementary::atan2(cross(last, step), dot(last, step)));
    last = step;
  }
  return sum;
}

// Whether a curve is so small, relative to its distance from the origin, that rounding determines
// its directions.
bool is_below_rounding(std::span<const Point2> controls) {
  double farthest = 0.0;
  double extent = 0.0;
  for (const Point2& point : controls) {
    const Point2 off = point - controls.front();
    farthest = std::max({farthest, std::fabs(point.x), std::fabs(point.y)});
    extent = std::max({extent, std::fabs(off.x), std::fabs(off.y)});
  }
  return extent > 0.0 && extent <= kMinRelativeStrokeTolerance * farthest;
}

double distance_from_chord(std::span<const Point2> controls) {
  const Point2 chord = controls.back() - controls.front();
  const double size = length(chord);
  double largest = 0.0;
  for (const Point2& point : controls) {
    const Point2 off = point - controls.front();
    largest = std::max(largest, size > 0.0 ? std::fabs(cross(chord, off)) / size : length(off));
  }
  return largest;
}

Point2 cubic_point(const Point2& a, const std::array<Point2, 2>& controls, const Point2& b,
                   double t) {
  const std::array<Point2, 4> points = {a, controls[0], controls[1], b};
  return point_at({points, 0.0}, t);
}

class PieceBuilder {
 public:
  PieceBuilder(double half_width, double tolerance)
      : half_width_(half_width),
        tolerance_(0.5 * tolerance),
        max_turning_(half_width > tolerance_
                         ? std::min(0.5, 2.0 * elementary::acos(1.0 - tolerance_ / half_width))
                         : 0.5) {}

  std::vector<StrokePiece> pieces_of(const StrokePath& path) {
    for (const PartOfCurve& part : path.curves) {
      const Curve curve = part.curve();
      const std::size_t first = pieces_.size();
      if (curve.degree() == 1) {
        append_line(curve.begin(), curve.end());
      } else {
        append_curve_pieces(curve, kMaxHalvings);
      }
      for (std::size_t i = first + 1; i < pieces_.size(); ++i) {
        if (!pieces_[i].is_cusp) pieces_[i].is_smooth = true;
      }
    }
    return std::move(pieces_);
  }

 private:
  void append_line(const Point2& begin, const Point2& end) {
    if (begin == end) return;
    StrokePiece piece;
    piece.begin = begin;
    piece.end = end;
    piece.begin_normal = piece.end_normal = left_of(unit(end - begin));
    if (!std::isfinite(piece.begin_normal.x + piece.begin_normal.y)) return;
    pieces_.push_back(piece);
  }

  void append_curve_pieces(const Curve& curve, int depth) {
    if (is_below_rounding(curve.controls)) {
      append_cusp(curve);
      return;
    }
    const double turn = turning(curve.controls);
    if (turn < 0.45 * std::numbers::pi && append_sides(curve)) return;
    const bool is_flat = distance_from_chord(curve.controls) <= tolerance_;
    if (is_flat && turn <= max_turning_) {
      append_flat(curve);
      return;
    }
    if (depth == 0) {
      append_cusp(curve);
      return;
    }
    append_curve_pieces(PartOfCurve(curve, 0.0, 0.5).curve(), depth - 1);
    append_curve_pieces(PartOfCurve(curve, 0.5, 1.0).curve(), depth - 1);
  }

  void append_cusp(const Curve& curve) {
    const std::size_t count = pieces_.size();
    append_line(curve.begin(), curve.end());
    if (pieces_.size() > count) pieces_.back().is_cusp = true;
    after_cusp_ = true;
  }

  StrokePiece with_normals(const Curve& curve, StrokePiece::Kind kind) {
    StrokePiece piece;
    piece.kind = kind;
    piece.begin = curve.begin();
    piece.end = curve.end();
    piece.begin_normal = left_of(begin_direction(curve.controls));
    piece.end_normal = left_of(end_direction(curve.controls));
    piece.is_cusp = std::exchange(after_cusp_, false);
    return piece;
  }

  // Appends a piece with cubic sides, from the ends and end derivatives of the offset curves, if
  // they are accurate enough.
  bool append_sides(const Curve& curve) {
    StrokePiece piece = with_normals(curve, StrokePiece::Kind::kCurve);
    const Point2 begin_step = derivative_at(curve, 0.0);
    const Point2 end_step = derivative_at(curve, 1.0);
    const double begin_curvature = curvature(curve.controls, curve.weight, false);
    const double end_curvature = curvature(curve.controls, curve.weight, true);
    if (!(length(begin_step) > 0.0) || !(length(end_step) > 0.0) ||
        !std::isfinite(begin_curvature + end_curvature)) {
      return false;
    }
    for (const double side : {half_width_, -half_width_}) {
      const double begin_stretch = 1.0 - side * begin_curvature;
      const double end_stretch = 1.0 - side * end_curvature;
      if (begin_stretch < 0.02 || end_stretch < 0.02) return false;
      const Point2 begin = piece.begin + side * piece.begin_normal;
      const Point2 end = piece.end + side * piece.end_normal;
      const std::array<Point2, 2> controls = {begin + (begin_stretch / 3.0) * begin_step,
                                              end - (end_stretch / 3.0) * end_step};
      for (const double t : {0.2, 0.5, 0.8}) {
        const Point2 step = derivative_at(curve, t);
        if (!(length(step) > 0.0)) return false;
        const Point2 ahead = unit(step);
        const Point2 expected = point_at(curve, t) + side * left_of(ahead);
        const Point2 off = cubic_point(begin, controls, end, t) - expected;
        // An error along the curve only shifts its parameter.
        if (!(std::fabs(cross(ahead, off)) <= 0.7 * tolerance_) ||
            !(std::fabs(dot(ahead, off)) <= 20.0 * tolerance_)) {
          return false;
        }
      }
      (side > 0.0 ? piece.left_controls : piece.right_controls) = controls;
    }
    pieces_.push_back(piece);
    return true;
  }

  // Signed curvature at an end.
  static double curvature(std::span<const Point2> controls, double weight, bool at_end) {
    const std::size_t last = controls.size() - 1;
    const Point2 first_step =
        at_end ? controls[last] - controls[last - 1] : controls[1] - controls[0];
    const Point2 second_step =
        at_end ? controls[last - 1] - controls[last - 2] : controls[2] - controls[1];
    const double size = length(first_step);
    const double turn = at_end ? cross(second_step, first_step) : cross(first_step, second_step);
    const double degree = static_cast<double>(last);
    const double factor = weight > 0.0 ? 0.5 / (weight * weight) : (degree - 1.0) / degree;
    return factor * turn / (size * size * size);
  }

  void append_flat(const Curve& curve) {
    if (curve.begin() == curve.end()) return;
    StrokePiece piece = with_normals(curve, StrokePiece::Kind::kFlat);
    pieces_.push_back(piece);
  }

  double half_width_;
  double tolerance_;
  double max_turning_;
  bool after_cusp_ = false;
  std::vector<StrokePiece> pieces_;
};

}  // namespace

std::vector<StrokePiece> stroke_pieces(const StrokePath& path, double half_width,
                                       double tolerance) {
  return PieceBuilder(half_width, tolerance).pieces_of(path);
}

}  // namespace prefilter
