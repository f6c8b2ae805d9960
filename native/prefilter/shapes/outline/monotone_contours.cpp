// SPDX-License-Identifier: GPL-3.0-or-later

// Cuts segments at the extrema of both coordinates, the roots of the derivative in Bernstein form,
// and groups consecutive pieces into monotone runs.
#include "prefilter/shapes/outline/monotone_contours.h"

#include <algorithm>
#include <array>

namespace prefilter {
namespace {

constexpr double kMinParameterStep =
    1e-9;  // a coordinate differs from its extremum by the square of this

// Appends the parameters of a coordinate's extrema.
void append_extrema(const Curve& curve, double Point2::*axis, std::vector<double>* turns) {
  const auto& p = curve.controls;
  const int degree = curve.degree();
  std::array<double, Outline::kMostDegree> slope;
  int count = degree;
  if (curve.weight > 0.0) {
    // The numerator of the derivative, in Bernstein form.
    slope[0] = curve.weight * (p[1].*axis - p[0].*axis);
    slope[1] = 0.5 * (p[2].*axis - p[0].*axis);
    slope[2] = curve.weight * (p[2].*axis - p[1].*axis);
    count = 3;
  } else {
    for (int i = 0; i < degree; ++i) slope[i] = p[i + 1].*axis - p[i].*axis;
  }
  append_sign_changes(std::span(slope).first(count), 0.0, 1.0, turns);
}

bool is_monotone(std::span<const Point2> controls) {
  double step_x = 0.0;
  double step_y = 0.0;
  for (std::size_t i = 0; i + 1 < controls.size(); ++i) {
    const Point2 step = controls[i + 1] - controls[i];
    if (step.x * step_x < 0.0 || step.y * step_y < 0.0) return false;
    if (step.x != 0.0) step_x = step.x < 0.0 ? -1.0 : 1.0;
    if (step.y != 0.0) step_y = step.y < 0.0 ? -1.0 : 1.0;
  }
  return true;
}

}  // namespace

MonotoneContours::MonotoneContours(std::span<const Outline* const> outlines)
    : arena_(std::make_unique<std::pmr::monotonic_buffer_resource>()) {
  for (std::size_t layer = 0; layer < outlines.size(); ++layer) {
    const Outline& outline = *outlines[layer];
    contours_.reserve(contours_.size() + outline.contour_count());
    for (std::size_t index = 0; index < outline.contour_count(); ++index) {
      Contour contour;
      contour.outline = &outline;
      contour.layer = static_cast<std::uint32_t>(layer);
      contour.index = static_cast<std::uint32_t>(index);
      add(contour);
    }
  }
}

template <typename T>
T* MonotoneContours::keep(std::span<const T> values) {
  auto* kept = static_cast<T*>(arena_->allocate(values.size() * sizeof(T), alignof(T)));
  std::uninitialized_copy(values.begin(), values.end(), kept);
  return kept;
}

void MonotoneContours::add(Contour contour) {
  const auto segments = contour.outline->contour(contour.index);
  if (segments.empty()) return;
  contour.first_run = static_cast<std::uint32_t>(runs_.size());
  // Degrees are at least 1, so this sum shows that all of them are 1.
  const bool lines = segments.back().first + static_cast<std::uint32_t>(segments.back().degree) -
                         segments.front().first ==
                     segments.size();
  const Point2* points = contour.outline->points().data() + segments.front().first;
  if (lines && points[segments.size()] == points[0]) {
    contour.joints = points;
    contour.pieces = static_cast<std::uint32_t>(segments.size());
    if (add_runs(&contour)) {
      contours_.push_back(contour);
      return;
    }
    runs_.resize(contour.first_run);
  }
  cut(&contour);
  if (contour.pieces == 0) return;
  add_runs(&contour);
  contours_.push_back(contour);
}

void MonotoneContours::cut(Contour* contour) {
  const Outline& outline = *contour->outline;
  const auto segments = outline.contour(contour->index);
  const Point2& begin = outline.begin_of(contour->index);
  cut_.clear();
  joints_.assign(1, begin);
  for (std::size_t s = 0; s < segments.size(); ++s) {
    cut_segment(curve_of(outline, segments[s]), static_cast<std::uint32_t>(s));
  }
  if (!(joints_.back() == begin)) {
    const std::array<Point2, 2> line = {joints_.back(), begin};
    cut_.push_back({MonotonePiece::kClosing, 0.0, 1.0, {keep<Point2>(line), 2}});
    joints_.push_back(begin);
  }
  contour->pieces = static_cast<std::uint32_t>(cut_.size());
  contour->joints = keep<Point2>(joints_);
  contour->cut_pieces = keep<MonotonePiece>(cut_);
}

// Parts without an extent are left out; neighbors in the segment take over their parameters.
void MonotoneContours::cut_segment(const Curve& curve, std::uint32_t segment) {
  if (curve.degree() == 1 || is_monotone(curve.controls)) {
    if (curve.begin() == curve.end()) return;
    cut_.push_back({segment, 0.0, 1.0, curve.controls});
    joints_.push_back(curve.end());
    return;
  }
  turns_.clear();
  append_extrema(curve, &Point2::x, &turns_);
  append_extrema(curve, &Point2::y, &turns_);
  if (turns_.empty()) {
    // The control polygon may turn back although the curve does not.
    if (curve.begin() == curve.end()) return;
    cut_.push_back({segment, 0.0, 1.0, curve.controls});
    joints_.push_back(curve.end());
    return;
  }
  std::sort(turns_.begin(), turns_.end());
  turns_.push_back(1.0);
  const std::size_t first = cut_.size();
  double from = 0.0;
  for (const double to : turns_) {
    if (to < 1.0 && (to - from < kMinParameterStep || 1.0 - to < kMinParameterStep)) continue;
    const PartOfCurve part(curve, from, to);
    const std::span<const Point2> part_controls = part.curve().controls;
    const Point2 end = to == 1.0 ? curve.end() : part_controls.back();
    if (joints_.back() == end) {
      if (to == 1.0 && cut_.size() > first) cut_.back().to = 1.0;
      continue;
    }
    Point2* controls = keep(part_controls);
    controls[0] = joints_.back();
    controls[part_controls.size() - 1] = end;
    cut_.push_back({segment, from, to, {controls, part_controls.size()}});
    joints_.push_back(end);
    from = to;
  }
}

// Groups the pieces into runs. Returns false if one of the contour's pieces has no extent.
bool MonotoneContours::add_runs(Contour* contour) {
  const Point2* joints = contour->joints;
  const std::uint32_t count = contour->pieces;
  const auto index = static_cast<std::uint32_t>(contours_.size());
  std::uint32_t i = 0;
  while (i < count) {
    const std::uint32_t first = i;
    double step_x = 0.0;
    double step_y = 0.0;
    for (; i < count; ++i) {
      const double x = joints[i + 1].x - joints[i].x;
      const double y = joints[i + 1].y - joints[i].y;
      if (x * step_x > 0.0 && y * step_y > 0.0) continue;
      if (x * step_x < 0.0 || y * step_y < 0.0) break;
      if (x == 0.0 && y == 0.0) return false;
      if (x != 0.0) step_x = x < 0.0 ? -1.0 : 1.0;
      if (y != 0.0) step_y = y < 0.0 ? -1.0 : 1.0;
    }
    runs_.push_back({joints + first, i - first, index, first});
    box_.include(joints[first]);
    box_.include(joints[i]);
  }
  contour->runs = static_cast<std::uint32_t>(runs_.size()) - contour->first_run;
  return true;
}

}  // namespace prefilter
