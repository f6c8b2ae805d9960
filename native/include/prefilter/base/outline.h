// SPDX-License-Identifier: GPL-3.0-or-later

// Outlines in the plane: contours of lines, Bezier curves of any degree, and conics.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "prefilter/base/elementary.h"
#include "prefilter/base/names.h"

namespace prefilter {

/// A point or a direction in the plane.
struct Point2 {
  double x = 0.0;
  double y = 0.0;

  friend bool operator==(const Point2&, const Point2&) = default;
};

inline Point2 operator+(const Point2& a, const Point2& b) { return {a.x + b.x, a.y + b.y}; }
inline Point2 operator-(const Point2& a, const Point2& b) { return {a.x - b.x, a.y - b.y}; }
inline Point2 operator*(double s, const Point2& a) { return {s * a.x, s * a.y}; }
inline double dot(const Point2& a, const Point2& b) { return a.x * b.x + a.y * b.y; }
inline double length(const Point2& a) { return elementary::hypot(a.x, a.y); }
/// The area of the parallelogram, positive if b is to the left of a.
inline double cross(const Point2& a, const Point2& b) { return a.x * b.y - a.y * b.x; }

/// The affine map of a point p to origin + p.x * x_axis + p.y * y_axis.
struct AffineMap2 {
  Point2 x_axis{1.0, 0.0};
  Point2 y_axis{0.0, 1.0};
  Point2 origin{};

  Point2 operator()(const Point2& p) const { return origin + linear(p); }
  /// Transforms a direction.
  Point2 linear(const Point2& p) const { return p.x * x_axis + p.y * y_axis; }
};

/// The points inside: nonzero or odd winding numbers.
enum class FillRule : std::uint8_t { kNonzero, kEvenOdd };

inline constexpr Named<FillRule> kFillRules[] = {{"nonzero", FillRule::kNonzero},
                                                 {"evenodd", FillRule::kEvenOdd}};

/// Contours, each a chain of segments: Bezier curves of degree 1 or more, or rational quadratics.
/// The inside of a counterclockwise contour, if y points upwards, is on its left.
class Outline {
 public:
  static constexpr int kMostDegree = 60;

  struct Segment {
    std::uint32_t first = 0;  // first control point; the next `degree` points follow it
    std::int32_t degree = 1;
    double weight = 0.0;  // 0: polynomial; else a conic with middle weight `weight`, end weights 1
  };

  /// Starts a contour. A contour without segments is a point, and fills nothing.
  void move_to(const Point2& point);
  void line_to(const Point2& point);
  /// A curve from the current point, with the control points after that; the last is its end.
  void curve_to(std::span<const Point2> points);
  void conic_to(const Point2& control, double weight, const Point2& end);
  /// A line back to the start of the contour, unless it is already there. Further segments start a
  /// new contour at that point, unless a move precedes them.
  void close();
  /// Appends all contours of another outline.
  void append(const Outline& other);
  void reserve(std::size_t points, std::size_t segments);

  bool empty() const { return segments_.empty(); }
  std::span<const Point2> points() const { return points_; }
  std::span<const Segment> segments() const { return segments_; }
  std::size_t contour_count() const { return contours_.size(); }
  /// The segments of a contour, in order: each starts at the end of the one before.
  std::span<const Segment> contour(std::size_t index) const;
  /// The start of a contour, and whether it was closed. Open contours are filled as if closed by a
  /// line.
  const Point2& begin_of(std::size_t index) const { return points_[contours_[index].first_point]; }
  bool is_closed(std::size_t index) const { return contours_[index].is_closed; }
  /// All points of a contour, in order; one more than its segments if these are lines.
  std::span<const Point2> contour_points(std::size_t index) const;
  /// The degree + 1 control points of a segment.
  std::span<const Point2> controls(const Segment& segment) const {
    return {points_.data() + segment.first, static_cast<std::size_t>(segment.degree) + 1};
  }

  Outline transformed(const AffineMap2& map) const;

 private:
  struct Contour {
    std::uint32_t first_point = 0;
    std::uint32_t first_segment = 0;
    bool is_closed = false;
  };
  void begin_segment();

  std::vector<Point2> points_;
  std::vector<Segment> segments_;
  std::vector<Contour> contours_;
};

/// Bounding box of an outline's control points, which contains its curves. The low corner is above
/// the high one if there are no points.
struct Box2 {
  Point2 low{HUGE_VAL, HUGE_VAL};
  Point2 high{-HUGE_VAL, -HUGE_VAL};

  bool empty() const { return !(low.x <= high.x && low.y <= high.y); }
  void include(const Point2& point);
};
Box2 control_box(const Outline& outline);

}  // namespace prefilter
