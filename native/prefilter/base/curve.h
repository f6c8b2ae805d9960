// SPDX-License-Identifier: GPL-3.0-or-later

// One segment of an outline: points, parts, and how finely lines follow it.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "prefilter/base/outline.h"

namespace prefilter {

/// A segment's control points, and its weight as Outline::Segment has it.
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

/// Room for a curve's control points. Only those that there are get written or copied.
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

/// The point at t in [0, 1]; at 0 and 1 the ends, bit for bit.
Point2 point_at(const Curve& curve, double t);

Point2 derivative_at(const Curve& curve, double t);

/// Appends a curve to the contour that an outline ends with, `end` in place of its last point; or
/// backward, `end` in place of its first.
void append_curve(const Curve& curve, bool reversed, const Point2& end, Outline* outline);

/// Appends a contour that has segments, closed, or closed and backward.
void append_contour(const Outline& from, std::size_t index, bool reversed, Outline* to);

/// The curve between two parameters, `from` <= `to`, with control points of its own.
class PartOfCurve {
 public:
  PartOfCurve(const Curve& curve, double from, double to);

  Curve curve() const { return {points_.span(), weight_}; }

 private:
  ControlPoints points_;
  double weight_;
};

/// Appends points of the curve, without its beginning and with its end, so that the lines between
/// them are within `tolerance` of it; 2^14 of them at the most.
void append_flattened(const Curve& curve, double tolerance, std::vector<Point2>* points);

/// Appends where a polynomial in Bernstein form on [from, to], by its coefficients, changes its
/// sign inside.
void append_sign_changes(std::span<const double> coefficients, double from, double to,
                         std::vector<double>* changes);

}  // namespace prefilter
