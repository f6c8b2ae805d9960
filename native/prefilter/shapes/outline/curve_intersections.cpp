// SPDX-License-Identifier: GPL-3.0-or-later

// Intersections of two monotone curve pieces by recursive subdivision: control hulls that are
// disjoint are dropped, and Newton's iteration converges on the intersection of transversal pieces.
#include "prefilter/shapes/outline/curve_intersections.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "prefilter/base/elementary.h"

namespace prefilter {
namespace {

// Bounds the subdivision of two pieces that touch or almost overlap.
constexpr int kMaxSearchSteps = 20000;

double distance(const Point2& a, const Point2& b) { return length(a - b); }

struct Range {
  double low = HUGE_VAL;
  double high = -HUGE_VAL;
};

// The signed distances of points from a line, times the length of its direction.
Range offsets(std::span<const Point2> points, const Point2& origin, const Point2& direction) {
  Range range;
  for (const Point2& point : points) {
    const double offset = cross(direction, point - origin);
    range.low = std::min(range.low, offset);
    range.high = std::max(range.high, offset);
  }
  return range;
}

bool boxes_meet(std::span<const Point2> a, std::span<const Point2> b, double margin) {
  Box2 first;
  Box2 second;
  for (const Point2& point : a) first.include(point);
  for (const Point2& point : b) second.include(point);
  return first.low.x <= second.high.x + margin && second.low.x <= first.high.x + margin &&
         first.low.y <= second.high.y + margin && second.low.y <= first.high.y + margin;
}

// Whether the control hulls lie on different sides of the line through the ends of `a`.
bool chord_separates(std::span<const Point2> a, std::span<const Point2> b, double margin) {
  const Point2 direction = a.back() - a.front();
  const double apart = margin * (std::fabs(direction.x) + std::fabs(direction.y));
  const Range own = offsets(a, a.front(), direction);
  const Range other = offsets(b, a.front(), direction);
  return other.low > own.high + apart || other.high < own.low - apart;
}

// Whether two hulls are farther apart than a margin.
bool hulls_apart(std::span<const Point2> a, std::span<const Point2> b, double margin) {
  return !boxes_meet(a, b, margin) || chord_separates(a, b, margin) ||
         chord_separates(b, a, margin);
}

// Part of a curve with its control points, halved recursively.
class CurveCell {
 public:
  explicit CurveCell(const CurvePiece& piece)
      : from_(piece.from), to_(piece.to), points_(piece.controls) {
    const Curve& curve = piece.curve;
    if (curve.weight > 0.0) {
      is_conic_ = true;
      weights_ = {1.0, curve.weight, 1.0};
      if (from_ > 0.0 || to_ < 1.0) {
        // The weights of a part of a conic are the blossom of the whole conic's weights.
        const double w = curve.weight;
        const auto blossom = [w](double s, double t) {
          return (1.0 - s) * (1.0 - t) + ((1.0 - s) * t + s * (1.0 - t)) * w + s * t;
        };
        weights_ = {blossom(from_, from_), blossom(from_, to_), blossom(to_, to_)};
      }
    }
  }

  std::span<const Point2> points() const { return points_.span(); }
  const Point2& begin() const { return points_[0]; }
  const Point2& end() const { return points_[points_.size() - 1]; }
  double from() const { return from_; }
  double to() const { return to_; }
  double middle() const { return 0.5 * (from_ + to_); }
  double size() const {
    const Point2 chord = end() - begin();
    return std::max(std::fabs(chord.x), std::fabs(chord.y));
  }
  bool is_line() const { return points_.size() == 2; }
  /// Largest distance of a control point from the chord's line.
  double thickness() const {
    if (is_line()) return 0.0;
    const Point2 chord = end() - begin();
    const Range range = offsets(points(), begin(), chord);
    return std::max(range.high, -range.low) / length(chord);
  }

  std::array<CurveCell, 2> halves() const {
    std::array<CurveCell, 2> parts = {*this, *this};
    auto& [first, second] = parts;
    first.to_ = second.from_ = middle();
    if (is_conic_) {
      split_conic(&first, &second);
      return parts;
    }
    const std::size_t count = points_.size();
    for (std::size_t level = 0; level < count; ++level) {
      first.points_[level] = second.points_[0];
      for (std::size_t i = 0; i + 1 < count - level; ++i) {
        second.points_[i] = 0.5 * (second.points_[i] + second.points_[i + 1]);
      }
    }
    return parts;
  }

 private:
  void split_conic(CurveCell* first, CurveCell* second) const {
    const double left = weights_[0] + weights_[1];
    const double right = weights_[1] + weights_[2];
    const double whole = left + right;
    first->points_[1] = (weights_[0] / left) * points_[0] + (weights_[1] / left) * points_[1];
    second->points_[1] = (weights_[1] / right) * points_[1] + (weights_[2] / right) * points_[2];
    first->points_[2] = second->points_[0] =
        (left / whole) * first->points_[1] + (right / whole) * second->points_[1];
    first->weights_ = {weights_[0], 0.5 * left, 0.25 * whole};
    second->weights_ = {0.25 * whole, 0.5 * right, weights_[2]};
  }

  double from_;
  double to_;
  bool is_conic_ = false;
  std::array<double, 3> weights_{};
  ControlPoints points_;
};

bool cells_apart(const CurveCell& a, const CurveCell& b, double margin, int depth) {
  if (hulls_apart(a.points(), b.points(), margin)) return true;
  if (depth == 0 || (a.is_line() && b.is_line())) return false;
  const bool halve_a = !a.is_line() && (b.is_line() || a.size() >= b.size());
  for (const CurveCell& half : (halve_a ? a : b).halves()) {
    if (!(halve_a ? cells_apart(half, b, margin, depth - 1)
                  : cells_apart(a, half, margin, depth - 1))) {
      return false;
    }
  }
  return true;
}

// Whether a line through the end of `a`, where `b` begins, separates the pieces.
bool joint_separates(std::span<const Point2> a, std::span<const Point2> b) {
  const Point2& joint = b.front();
  const Point2 back = a.front() - joint;
  const Point2 ahead = b.back() - joint;
  const Point2 direction = std::sqrt(dot(back, back)) * ahead - std::sqrt(dot(ahead, ahead)) * back;
  for (std::size_t i = 0; i + 1 < a.size(); ++i) {
    const Point2 step = a[i] - joint;
    if (!(step == Point2{}) && dot(step, direction) >= 0.0) return false;
  }
  for (std::size_t i = 1; i < b.size(); ++i) {
    const Point2 step = b[i] - joint;
    if (!(step == Point2{}) && dot(step, direction) <= 0.0) return false;
  }
  return true;
}

bool cells_meet_only_at_joint(const CurveCell& a, const CurveCell& b, int depth) {
  if (a.begin() == b.end() || a.begin() == a.end() || b.begin() == b.end()) return false;
  if (joint_separates(a.points(), b.points())) return true;
  if (depth == 0) return false;
  const auto [a_far, a_near] = a.halves();
  const auto [b_near, b_far] = b.halves();
  return cells_apart(a_far, b, 0.0, 8) && cells_apart(a_near, b_far, 0.0, 8) &&
         cells_meet_only_at_joint(a_near, b_near, depth - 1);
}

// Cone of directions that holds all tangents of a monotone cell. It is spanned by the steps between
// control points, which lie within a quarter turn.
struct Cone {
  Point2 right;
  Point2 left;
};

bool cone_of(const CurveCell& cell, Cone* cone) {
  const Point2 chord = cell.end() - cell.begin();
  cone->right = cone->left = chord;
  for (std::size_t i = 0; i + 1 < cell.points().size(); ++i) {
    const Point2 step = cell.points()[i + 1] - cell.points()[i];
    if (step == Point2{}) continue;
    if (dot(step, chord) <= 0.0) return false;
    if (cross(cone->right, step) < 0.0) cone->right = step;
    if (cross(cone->left, step) > 0.0) cone->left = step;
  }
  return true;
}

// Whether no tangent of one cell is parallel to a tangent of the other; such cells intersect at
// most once.
bool are_transversal(const CurveCell& a, const CurveCell& b) {
  Cone first;
  Cone second;
  if (!cone_of(a, &first) || !cone_of(b, &second)) return false;
  const std::array<double, 4> turns = {
      cross(first.right, second.right), cross(first.right, second.left),
      cross(first.left, second.right), cross(first.left, second.left)};
  return *std::min_element(turns.begin(), turns.end()) > 0.0 ||
         *std::max_element(turns.begin(), turns.end()) < 0.0;
}

class IntersectionFinder {
 public:
  IntersectionFinder(const CurvePiece& a, const CurvePiece& b, double precision,
                     std::vector<CurveIntersection>* intersections)
      : a_(a), b_(b), precision_(precision), intersections_(intersections) {}

  bool find() {
    if (a_.curve.degree() == 1 && b_.curve.degree() == 1 && append_corner()) return true;
    append_ends();
    if (run_together()) return true;
    if (a_.curve.degree() == 1 && b_.curve.degree() == 1) {
      intersect_lines(CurveCell(a_), CurveCell(b_));
      return true;
    }
    return search(CurveCell(a_), CurveCell(b_));
  }

 private:
  // Appends the common end of two lines that leave it in clearly different directions.
  bool append_corner() {
    for (const bool at_end_of_a : {false, true}) {
      for (const bool at_end_of_b : {false, true}) {
        const Point2& corner = at_end_of_a ? a_.end() : a_.begin();
        if (!(corner == (at_end_of_b ? b_.end() : b_.begin()))) continue;
        const Point2 first = (at_end_of_a ? a_.begin() : a_.end()) - corner;
        const Point2 second = (at_end_of_b ? b_.begin() : b_.end()) - corner;
        const double turn = cross(first, second);
        const double least = 16.0 * precision_ * precision_;
        if (turn * turn <= least * std::max(dot(first, first), dot(second, second))) return false;
        append(at_end_of_a ? a_.to : a_.from, at_end_of_b ? b_.to : b_.from, corner);
        return true;
      }
    }
    return false;
  }

  // Appends ends of one piece that lie on the other; ends that almost coincide are paired.
  void append_ends() {
    for (const double s : {a_.from, a_.to}) {
      const Point2& end = s == a_.from ? a_.begin() : a_.end();
      const double t = parameter_near(b_, end, precision_);
      if (t >= 0.0) intersections_->push_back({s, t, end});
    }
    for (const double t : {b_.from, b_.to}) {
      const Point2& end = t == b_.from ? b_.begin() : b_.end();
      const double s = parameter_near(a_, end, precision_);
      if (s > a_.from && s < a_.to) intersections_->push_back({s, t, end});
    }
  }

  // Two monotone pieces that overlap anywhere do so from one end to another.
  bool run_together() const {
    const auto intersections = std::span(*intersections_).subspan(first_);
    for (std::size_t i = 0; i + 1 < intersections.size(); ++i) {
      for (std::size_t j = i + 1; j < intersections.size(); ++j) {
        const CurveIntersection& first = intersections[i];
        const CurveIntersection& second = intersections[j];
        if (distance(first.point, second.point) <= 4.0 * precision_) continue;
        if (runs_along(a_, first.a, second.a, b_, 4.0 * precision_)) return true;
      }
    }
    return false;
  }

  void append(double s, double t, const Point2& point) { intersections_->push_back({s, t, point}); }

  bool search(const CurveCell& a, const CurveCell& b) {
    if (++steps_ > kMaxSearchSteps) return false;
    if (hulls_apart(a.points(), b.points(), 0.0)) return true;
    const double small = 0.25 * precision_;
    if (a.size() <= small || b.size() <= small) {
      append_small(a, b);
      return true;
    }
    if (are_transversal(a, b)) {
      switch (converge(a, b)) {
        case Outcome::kMeet:
        case Outcome::kMiss:
          return true;
        case Outcome::kUnknown:
          break;
      }
    } else if (a.thickness() <= small && b.thickness() <= small) {
      intersect_lines(a, b);
      return true;
    }
    const bool halve_a = !a.is_line() && (b.is_line() || a.size() >= b.size());
    for (const CurveCell& half : (halve_a ? a : b).halves()) {
      if (!(halve_a ? search(half, b) : search(a, half))) return false;
    }
    return true;
  }

  // Handles cells of which one is smaller than the precision.
  void append_small(const CurveCell& a, const CurveCell& b) {
    if (a.size() <= b.size()) {
      const double t = parameter_near(b_, a.begin(), precision_);
      if (t >= 0.0) append(a.from(), t, a.begin());
    } else {
      const double s = parameter_near(a_, b.begin(), precision_);
      if (s >= 0.0) append(s, b.from(), b.begin());
    }
  }

  enum class Outcome : std::uint8_t { kMeet, kMiss, kUnknown };

  // Finds the one possible intersection of two cells by Newton's iteration.
  Outcome converge(const CurveCell& a, const CurveCell& b) {
    double s = a.middle();
    double t = b.middle();
    for (int i = 0; i < 12; ++i) {
      const Point2 at_a = point_at(a_.curve, s);
      const Point2 off = point_at(b_.curve, t) - at_a;
      const Point2 along_a = derivative_at(a_.curve, s);
      const Point2 along_b = derivative_at(b_.curve, t);
      const double turn = cross(along_a, along_b);
      if (turn == 0.0) return Outcome::kUnknown;
      const double step_s = cross(off, along_b) / turn;
      const double step_t = cross(off, along_a) / turn;
      s += step_s;
      t += step_t;
      const double slack_a = 0.5 * (a.to() - a.from());
      const double slack_b = 0.5 * (b.to() - b.from());
      if (!(s > a.from() - slack_a && s < a.to() + slack_a && t > b.from() - slack_b &&
            t < b.to() + slack_b)) {
        return Outcome::kUnknown;
      }
      s = std::clamp(s, 0.0, 1.0);
      t = std::clamp(t, 0.0, 1.0);
      if (std::fabs(step_s) + std::fabs(step_t) > 1e-13) continue;
      if (distance(point_at(a_.curve, s), point_at(b_.curve, t)) > 0.25 * precision_) {
        return Outcome::kUnknown;
      }
      // The cell next to this one also finds intersections just beyond this cell's end; those at
      // the ends of the whole pieces have been appended already.
      constexpr double kCellSlack = 1e-12;
      if (s < a.from() - kCellSlack || s > a.to() + kCellSlack || t < b.from() - kCellSlack ||
          t > b.to() + kCellSlack) {
        return Outcome::kMiss;
      }
      append(s, t, point_at(a_.curve, s));
      return Outcome::kMeet;
    }
    return Outcome::kUnknown;
  }

  // Intersects cells that are straight within the precision.
  void intersect_lines(const CurveCell& a, const CurveCell& b) {
    const Point2 along_a = a.end() - a.begin();
    const Point2 along_b = b.end() - b.begin();
    const double begin_of_b = cross(along_a, b.begin() - a.begin());
    const double end_of_b = cross(along_a, b.end() - a.begin());
    const double begin_of_a = cross(along_b, a.begin() - b.begin());
    const double end_of_a = cross(along_b, a.end() - b.begin());
    if (std::max(std::fabs(begin_of_b), std::fabs(end_of_b)) <= precision_ * length(along_a) ||
        std::max(std::fabs(begin_of_a), std::fabs(end_of_a)) <= precision_ * length(along_b)) {
      append_overlap(a, b);
      return;
    }
    if ((begin_of_b > 0.0) == (end_of_b > 0.0) || (begin_of_a > 0.0) == (end_of_a > 0.0)) return;
    const double s = begin_of_a / (begin_of_a - end_of_a);
    const double t = begin_of_b / (begin_of_b - end_of_b);
    append((1.0 - s) * a.from() + s * a.to(), (1.0 - t) * b.from() + t * b.to(),
           (1.0 - s) * a.begin() + s * a.end());
  }

  // Appends the ends of the common part of two overlapping cells. A cell can be so short that it
  // lies across the other; then a point whose projection is on the chord may still be far from it.
  void append_overlap(const CurveCell& a, const CurveCell& b) {
    const auto share_of = [this](const CurveCell& cell, const Point2& point) {
      const Point2 chord = cell.end() - cell.begin();
      const double share = dot(point - cell.begin(), chord) / dot(chord, chord);
      if (!(share >= 0.0 && share <= 1.0)) return -1.0;
      const Point2 nearest = (1.0 - share) * cell.begin() + share * cell.end();
      return distance(point, nearest) <= 2.0 * precision_ ? share : -1.0;
    };
    for (const bool at_end : {false, true}) {
      const double t = share_of(b, at_end ? a.end() : a.begin());
      if (t >= 0.0) {
        append(at_end ? a.to() : a.from(), (1.0 - t) * b.from() + t * b.to(),
               at_end ? a.end() : a.begin());
      }
      const double s = share_of(a, at_end ? b.end() : b.begin());
      if (s >= 0.0) {
        append((1.0 - s) * a.from() + s * a.to(), at_end ? b.to() : b.from(),
               at_end ? b.end() : b.begin());
      }
    }
  }

  const CurvePiece& a_;
  const CurvePiece& b_;
  double precision_;
  std::vector<CurveIntersection>* intersections_;
  std::size_t first_ = intersections_->size();
  int steps_ = 0;
};

}  // namespace

bool are_apart(const CurvePiece& a, const CurvePiece& b, double precision) {
  if (chord_separates(a.controls, b.controls, precision) ||
      chord_separates(b.controls, a.controls, precision)) {
    return true;
  }
  if (a.curve.degree() == 1 && b.curve.degree() == 1) return false;
  return cells_apart(CurveCell(a), CurveCell(b), precision, 12);
}

bool meet_only_at_joint(const CurvePiece& a, const CurvePiece& b) {
  if (a.begin() == b.end()) return false;
  if (joint_separates(a.controls, b.controls)) return true;
  if (a.curve.degree() == 1 && b.curve.degree() == 1) return false;
  return cells_meet_only_at_joint(CurveCell(a), CurveCell(b), 12);
}

bool append_intersections(const CurvePiece& a, const CurvePiece& b, double precision,
                          std::vector<CurveIntersection>* intersections) {
  return IntersectionFinder(a, b, precision, intersections).find();
}

double parameter_near(const CurvePiece& piece, const Point2& point, double precision) {
  if (distance(point, piece.begin()) <= precision) return piece.from;
  if (distance(point, piece.end()) <= precision) return piece.to;
  const Point2 chord = piece.end() - piece.begin();
  const Range range = offsets(piece.controls, piece.begin(), chord);
  const double offset = cross(chord, point - piece.begin());
  const double margin = precision * length(chord);
  if (offset < range.low - margin || offset > range.high + margin) return -1.0;
  const double along = dot(chord, point - piece.begin());
  if (along < -margin || along > dot(chord, chord) + margin) return -1.0;
  if (piece.curve.degree() == 1) {
    const double share = std::clamp(along / dot(chord, chord), 0.0, 1.0);
    const double t = (1.0 - share) * piece.from + share * piece.to;
    return distance(point_at(piece.curve, t), point) <= precision ? t : -1.0;
  }
  // Solving for one coordinate leaves the error in the other. The coordinate that changes faster
  // gives an error within the precision.
  for (const auto axis : {&Point2::x, &Point2::y}) {
    const bool rises = chord.*axis > 0.0;
    double low = piece.from;
    double high = piece.to;
    double t = 0.5 * (low + high);
    while (t > low && t < high) {
      ((point_at(piece.curve, t).*axis < point.*axis) == rises ? low : high) = t;
      t = 0.5 * (low + high);
    }
    if (distance(point_at(piece.curve, t), point) <= precision) return t;
  }
  return -1.0;
}

bool runs_along(const CurvePiece& a, double from, double to, const CurvePiece& b,
                double precision) {
  if (a.curve.degree() == 1 && b.curve.degree() == 1) return true;
  for (const double share : {0.15, 0.35, 0.5, 0.7, 0.9}) {
    const Point2 point = point_at(a.curve, (1.0 - share) * from + share * to);
    if (parameter_near(b, point, precision) < 0.0) return false;
  }
  return true;
}

}  // namespace prefilter
