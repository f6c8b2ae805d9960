// SPDX-License-Identifier: GPL-3.0-or-later

// Pairs of contours are found in a grid of boxes, separated by a line along an edge, or nested.
#include "prefilter/shapes/outline/convex_contours.h"

#include <algorithm>
#include <cmath>

#include "prefilter/base/curve.h"
#include "prefilter/shapes/outline/fill_rule.h"

namespace prefilter {
namespace {

// More points cost more than the arrangement.
constexpr std::size_t kMaxConvexPoints = 64;
constexpr double kMaxStraightTurn = 1e-24;  // squared radians; the effect of rounding

struct ConvexContour {
  std::span<const Point2> points;  // the control polygon; the last point may be the first
  std::span<const Outline::Segment> segments;
  std::uint32_t first_point = 0;
  Box2 box;
  double sign = 1.0;  // -1: clockwise
  int winding_around = 0;
  std::uint32_t index = 0;

  const Point2& next(std::size_t i) const { return points[i + 1 == points.size() ? 0 : i + 1]; }
};

// A closed polygon that turns only one way, and once around, is convex. Curves with such a control
// polygon are convex, too: a line crosses them no more often than the polygon.
bool measure(ConvexContour* contour) {
  const std::size_t count = contour->points.size();
  if (count < 3 || count > kMaxConvexPoints) return false;
  double sign = 0.0;
  Point2 last = contour->points[0] - contour->points[count - 1];
  for (std::size_t i = count - 1; last == Point2{} && i > 0; --i) {
    last = contour->points[i] - contour->points[i - 1];
  }
  double first_x = 0.0;
  double last_x = 0.0;
  int turns_back = 0;
  for (std::size_t i = 0; i < count; ++i) {
    contour->box.include(contour->points[i]);
    const Point2 step = contour->next(i) - contour->points[i];
    if (step == Point2{}) continue;
    const double turn = cross(last, step);
    if (turn * turn <= kMaxStraightTurn * dot(last, last) * dot(step, step)) {
      if (dot(last, step) < 0.0) return false;
    } else {
      if (turn * sign < 0.0) return false;
      sign = turn > 0.0 ? 1.0 : -1.0;
    }
    if (step.x != 0.0) {
      if (step.x * last_x < 0.0) ++turns_back;
      if (first_x == 0.0) first_x = step.x;
      last_x = step.x;
    }
    last = step;
  }
  if (first_x * last_x < 0.0) ++turns_back;
  contour->sign = sign;
  return sign != 0.0 && turns_back == 2;
}

// Whether a line along an edge of `a` separates `b` from it. Starts with the edge that faces `b`
// most.
bool is_separated(const ConvexContour& a, const ConvexContour& b, double margin) {
  const auto is_outside_of = [&](std::size_t edge) {
    const Point2& origin = a.points[edge];
    const Point2 step = a.sign * (a.next(edge) - origin);
    if (step == Point2{}) return false;
    const double most = margin * (std::fabs(step.x) + std::fabs(step.y));
    return std::all_of(b.points.begin(), b.points.end(),
                       [&](const Point2& p) { return cross(step, p - origin) <= most; });
  };
  const Point2 way = (b.box.low + b.box.high) - (a.box.low + a.box.high);
  double best = -HUGE_VAL;
  std::size_t best_edge = 0;
  for (std::size_t i = 0; i < a.points.size(); ++i) {
    const Point2 step = a.next(i) - a.points[i];
    const double square = dot(step, step);
    if (square == 0.0) continue;
    const double outward = -a.sign * cross(step, way);
    const double look = outward * std::fabs(outward) / square;
    if (look > best) {
      best = look;
      best_edge = i;
    }
  }
  if (is_outside_of(best_edge)) return true;
  for (std::size_t i = 0; i < a.points.size(); ++i) {
    if (i != best_edge && is_outside_of(i)) return true;
  }
  return false;
}

// Whether `outer` contains `inner`. Tests a polygon of the ends and midpoints of the curves of
// `outer`.
bool holds(const ConvexContour& outer, const ConvexContour& inner) {
  const Box2& a = outer.box;
  const Box2& b = inner.box;
  if (!(a.low.x <= b.low.x && a.low.y <= b.low.y && a.high.x >= b.high.x && a.high.y >= b.high.y)) {
    return false;
  }
  const auto is_inside_of = [&](const Point2& from, const Point2& to) {
    const Point2 step = outer.sign * (to - from);
    return std::all_of(inner.points.begin(), inner.points.end(),
                       [&](const Point2& p) { return cross(step, p - from) >= 0.0; });
  };
  for (const Outline::Segment& segment : outer.segments) {
    const std::size_t first = segment.first - outer.first_point;
    const std::size_t count = static_cast<std::size_t>(segment.degree) + 1;
    const Curve curve = {outer.points.subspan(first, count), segment.weight};
    if (is_inside_of(curve.begin(), curve.end())) continue;
    const Point2 middle = point_at(curve, 0.5);
    if (!is_inside_of(curve.begin(), middle) || !is_inside_of(middle, curve.end())) return false;
  }
  return is_inside_of(outer.points.back(), outer.points.front());
}

bool boxes_meet(const Box2& a, const Box2& b) {
  return a.low.x < b.high.x && b.low.x < a.high.x && a.low.y < b.high.y && b.low.y < a.high.y;
}

bool are_equal(const Box2& a, const Box2& b) { return a.low == b.low && a.high == b.high; }

// Counts how often one contour winds around the other; false unless they are nested or disjoint.
bool count_winding(ConvexContour* a, ConvexContour* b, double margin) {
  if (!boxes_meet(a->box, b->box)) return true;
  if (is_separated(*a, *b, margin) || is_separated(*b, *a, margin)) return true;
  if (are_equal(a->box, b->box)) return false;
  if (holds(*a, *b)) {
    b->winding_around += a->sign > 0.0 ? 1 : -1;
  } else if (holds(*b, *a)) {
    a->winding_around += b->sign > 0.0 ? 1 : -1;
  } else {
    return false;
  }
  return true;
}

// A grid that lists for each cell the contours whose boxes overlap it.
class BoxGrid {
 public:
  explicit BoxGrid(std::span<const ConvexContour> contours) {
    Point2 sizes;
    for (const ConvexContour& contour : contours) {
      whole_.include(contour.box.low);
      whole_.include(contour.box.high);
      sizes = sizes + (contour.box.high - contour.box.low);
    }
    const Point2 extent = whole_.high - whole_.low;
    const double count = static_cast<double>(contours.size());
    const double most = std::ceil(std::sqrt(count)) + 1.0;
    columns_ = static_cast<int>(std::clamp(count * extent.x / sizes.x, 1.0, most));
    rows_ = static_cast<int>(std::clamp(count * extent.y / sizes.y, 1.0, most));
    scale_ = {columns_ / extent.x, rows_ / extent.y};
    first_.assign(static_cast<std::size_t>(columns_) * rows_ + 1, 0);
    for (const ConvexContour& contour : contours) {
      visit(contour.box, [&](std::size_t cell) { ++first_[cell + 1]; });
    }
    for (std::size_t i = 1; i < first_.size(); ++i) first_[i] += first_[i - 1];
    members_.resize(first_.back());
    std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
    for (std::uint32_t i = 0; i < contours.size(); ++i) {
      visit(contours[i].box, [&](std::size_t cell) { members_[next[cell]++] = i; });
    }
  }

  std::size_t cells() const { return first_.size() - 1; }
  std::span<const std::uint32_t> members(std::size_t cell) const {
    return std::span(members_).subspan(first_[cell], first_[cell + 1] - first_[cell]);
  }
  /// The one cell, of all that two boxes share, in which the pair is tested.
  std::size_t common_cell(const Box2& a, const Box2& b) const {
    return cell_of({std::max(a.low.x, b.low.x), std::max(a.low.y, b.low.y)});
  }

 private:
  int column(double x) const {
    return std::clamp(static_cast<int>((x - whole_.low.x) * scale_.x), 0, columns_ - 1);
  }
  int row(double y) const {
    return std::clamp(static_cast<int>((y - whole_.low.y) * scale_.y), 0, rows_ - 1);
  }
  std::size_t cell_of(const Point2& point) const {
    return static_cast<std::size_t>(row(point.y)) * columns_ + column(point.x);
  }
  template <typename Visit>
  void visit(const Box2& box, const Visit& visit) const {
    for (int y = row(box.low.y); y <= row(box.high.y); ++y) {
      for (int x = column(box.low.x); x <= column(box.high.x); ++x) {
        visit(static_cast<std::size_t>(y) * columns_ + x);
      }
    }
  }

  Box2 whole_;
  Point2 scale_;
  int columns_ = 1;
  int rows_ = 1;
  std::vector<std::uint32_t> first_;
  std::vector<std::uint32_t> members_;
};

bool count_all_windings(std::span<ConvexContour> contours) {
  const BoxGrid bins(contours);
  Box2 whole;
  for (const ConvexContour& contour : contours) {
    whole.include(contour.box.low);
    whole.include(contour.box.high);
  }
  const Point2 extent = whole.high - whole.low;
  const double margin = std::ldexp(std::max(extent.x, extent.y), -44);
  std::size_t steps = 0;
  const std::size_t max_steps = 256 * contours.size() + 1024;
  for (std::size_t cell = 0; cell < bins.cells(); ++cell) {
    const auto members = bins.members(cell);
    for (std::size_t i = 0; i < members.size(); ++i) {
      ConvexContour& a = contours[members[i]];
      for (std::size_t j = i + 1; j < members.size(); ++j) {
        ConvexContour& b = contours[members[j]];
        if (!boxes_meet(a.box, b.box) || bins.common_cell(a.box, b.box) != cell) continue;
        if (!count_winding(&a, &b, margin)) return false;
      }
      steps += members.size() - i;
    }
    if (steps > max_steps) return false;
  }
  return true;
}

}  // namespace

std::optional<std::vector<ContourUse>> convex_contour_uses(const Outline& outline, FillRule rule) {
  std::vector<ConvexContour> contours;
  contours.reserve(outline.contour_count());
  for (std::size_t c = 0; c < outline.contour_count(); ++c) {
    ConvexContour contour;
    contour.segments = outline.contour(c);
    if (contour.segments.empty()) continue;
    contour.first_point = contour.segments.front().first;
    const Outline::Segment& last = contour.segments.back();
    contour.points = outline.points().subspan(
        contour.first_point,
        last.first + static_cast<std::uint32_t>(last.degree) + 1 - contour.first_point);
    contour.index = static_cast<std::uint32_t>(c);
    if (!measure(&contour)) return std::nullopt;
    contours.push_back(contour);
  }
  if (contours.size() > 1 && !count_all_windings(contours)) return std::nullopt;
  std::vector<ContourUse> uses(outline.contour_count(), ContourUse::kKept);
  for (const ConvexContour& contour : contours) {
    const int around = contour.winding_around;
    const bool is_outside = is_filled(around, rule);
    const bool is_inside = is_filled(around + (contour.sign > 0.0 ? 1 : -1), rule);
    if (is_outside == is_inside) {
      uses[contour.index] = ContourUse::kDropped;
    } else if (is_inside != (contour.sign > 0.0)) {
      uses[contour.index] = ContourUse::kReversed;
    }
  }
  return uses;
}

}  // namespace prefilter
