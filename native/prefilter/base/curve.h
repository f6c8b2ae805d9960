// SPDX-License-Identifier: GPL-3.0-or-later

// A single segment of an outline: evaluation, subdivision and flattening.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "prefilter/base/outline.h"

namespace prefilter {

/// A segment's control points, and its weight as in Outline::Segment.
struct Curve {
  std::span<const Point2> controls;
  double weight = 0.0;

  int degree() const { return static_cast<int>(controls.size()) - 1; }
  const Point2& begin() const { return controls.front(); }
  const Point2& end() const { return controls.back(); }
};

inline Curve curve_of(const Outline& outline, const Outline::Segment& segment) {
  return {outline.controls(segment), segment.weight};
}

/// Fixed storage for a curve's control points, of which only the used ones are written or copied.
class ControlPoints {
 public:
  explicit ControlPoints(std::span<const Point2> points) : count_(points.size()) {
    std::copy(points.begin(), points.end(), values_);
  }
  ControlPoints(const ControlPoints& other) : ControlPoints(other.span()) {}
  ControlPoints& operator=(const ControlPoints& other) {
    count_ = other.count_;
    std::copy_n(other.values_, count_, values_);
    return *this;
  }

  std::size_t size() const { return count_; }
  std::span<const Point2> span() const { return {values_, count_}; }
  std::span<Point2> span() { return {values_, count_}; }
  const Point2& operator[](std::size_t i) const { return values_[i]; }
  Point2& operator[](std::size_t i) { return values_[i]; }

 private:
  union {
    Point2 values_[Outline::kMostDegree + 1];
  };
  std::size_t count_;
};

/// The point at t in [0, 1]; exactly the end points at 0 and 1.
Point2 point_at(const Curve& curve, double t);

Point2 derivative_at(const Curve& curve, double t);

/// Appends a curve to the last contour of an outline, optionally reversed. Its end point is
/// replaced by `end`.
void append_curve(const Curve& curve, bool reversed, const Point2& end, Outline* outline);

/// Appends a contour with at least one segment as a closed contour, optionally reversed.
void append_contour(const Outline& from, std::size_t index, bool reversed, Outline* to);

/// The part of a curve between two parameters, `from` <= `to`, with its own control points.
class PartOfCurve {
 public:
  PartOfCurve(const Curve& curve, double from, double to);

  Curve curve() const { return {points_.span(), weight_}; }

 private:
  ControlPoints points_;
  double weight_;
};

/// Appends points of the curve, excluding its start but including its end, so that the chords are
/// within `tolerance` of it; at most 2^14 points.
void append_flattened(const Curve& curve, double tolerance, std::vector<Point2>* points);

/// Appends the sign changes, inside (from, to), of a polynomial given by its Bernstein coefficients
/// on [from, to].
void append_sign_changes(std::span<const double> coefficients, double from, double to,
                         std::vector<double>* changes);

}  // namespace prefilter
