// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/base/outline.h"

#include <algorithm>
#include <cassert>
#include <vector>

namespace prefilter {
namespace {

// Grows geometrically: exact reserves for each contour would copy the vector each time.
template <typename T>
void reserve_more(std::size_t count, std::vector<T>* values) {
  const std::size_t needed = values->size() + count;
  if (needed > values->capacity()) values->reserve(std::max(needed, 2 * values->capacity()));
}

}  // namespace

void Outline::move_to(const Point2& point) {
  contours_.push_back({static_cast<std::uint32_t>(points_.size()),
                       static_cast<std::uint32_t>(segments_.size()), false});
  points_.push_back(point);
}

// A segment starts at the last point: that of a move, or the end of the preceding segment.
void Outline::begin_segment() {
  assert(!contours_.empty());
  if (!contours_.back().is_closed) return;
  const Point2 begin = points_[contours_.back().first_point];
  move_to(begin);
}

void Outline::line_to(const Point2& point) { curve_to({&point, 1}); }

void Outline::curve_to(std::span<const Point2> points) {
  assert(!points.empty() && points.size() <= kMostDegree);
  begin_segment();
  segments_.push_back({static_cast<std::uint32_t>(points_.size() - 1),
                       static_cast<std::int32_t>(points.size()), 0.0});
  points_.insert(points_.end(), points.begin(), points.end());
}

void Outline::conic_to(const Point2& control, double weight, const Point2& end) {
  assert(weight > 0.0);
  const std::array<Point2, 2> points = {control, end};
  curve_to(points);
  segments_.back().weight = weight;
}

void Outline::close() {
  if (contours_.empty() || contours_.back().is_closed) return;
  const Point2 begin = points_[contours_.back().first_point];
  if (!(points_.back() == begin)) line_to(begin);
  contours_.back().is_closed = true;
}

void Outline::append(const Outline& other) {
  const auto first_point = static_cast<std::uint32_t>(points_.size());
  const auto first_segment = static_cast<std::uint32_t>(segments_.size());
  points_.insert(points_.end(), other.points_.begin(), other.points_.end());
  for (Segment segment : other.segments_) {
    segment.first += first_point;
    segments_.push_back(segment);
  }
  for (Contour contour : other.contours_) {
    contour.first_point += first_point;
    contour.first_segment += first_segment;
    contours_.push_back(contour);
  }
}

void Outline::reserve(std::size_t points, std::size_t segments) {
  reserve_more(points, &points_);
  reserve_more(segments, &segments_);
}

std::span<const Outline::Segment> Outline::contour(std::size_t index) const {
  const std::size_t first = contours_[index].first_segment;
  const std::size_t last =
      index + 1 < contours_.size() ? contours_[index + 1].first_segment : segments_.size();
  return std::span(segments_).subspan(first, last - first);
}

std::span<const Point2> Outline::contour_points(std::size_t index) const {
  const std::size_t first = contours_[index].first_point;
  const std::size_t last =
      index + 1 < contours_.size() ? contours_[index + 1].first_point : points_.size();
  return std::span(points_).subspan(first, last - first);
}

Outline Outline::transformed(const AffineMap2& map) const {
  Outline result = *this;
  std::transform(points_.begin(), points_.end(), result.points_.begin(), map);
  return result;
}

void Box2::include(const Point2& point) {
  low.x = std::min(low.x, point.x);
  low.y = std::min(low.y, point.y);
  high.x = std::max(high.x, point.x);
  high.y = std::max(high.y, point.y);
}

Box2 control_box(const Outline& outline) {
  Box2 box;
  for (const Point2& point : outline.points()) box.include(point);
  return box;
}

}  // namespace prefilter
