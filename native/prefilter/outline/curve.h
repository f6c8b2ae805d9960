// One segment of an outline: points, parts, and how finely lines follow it.
#pragma once

#include <array>
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

/// The point at t in [0, 1]; at 0 and 1 the ends, bit for bit.
Point2 point_at(const Curve& curve, double t);

/// The curve between two parameters, `from` <= `to`, with control points of its own.
class PartOfCurve {
 public:
  PartOfCurve(const Curve& curve, double from, double to);

  Curve curve() const { return {{points_.data(), count_}, weight_}; }

 private:
  std::array<Point2, Outline::kMostDegree + 1> points_;
  std::size_t count_;
  double weight_;
};

/// Appends points of the curve, without its beginning and with its end, so that the lines between
/// them are within `tolerance` of it; 2^14 of them at the most.
void append_flattened(const Curve& curve, double tolerance, std::vector<Point2>* points);

}  // namespace prefilter
