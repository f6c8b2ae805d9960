// SPDX-License-Identifier: GPL-3.0-or-later

// Coordinates are rounded to a grid of 2^41 steps, on which Clipper2 is exact.
#include "prefilter/shapes/outline/polygon_clipper.h"

#include <clipper2/clipper.engine.h>

#include <algorithm>
#include <cmath>

#include "prefilter/base/curve.h"

namespace prefilter {
namespace {

// ClipGrid with 2^41 steps across a box.
class ClipGrid {
 public:
  ClipGrid(const std::vector<Polygon>& first, const std::vector<Polygon>& second) {
    Box2 box;
    for (const auto* polygons : {&first, &second}) {
      for (const Polygon& polygon : *polygons) {
        for (const Point2& point : polygon) box.include(point);
      }
    }
    if (box.empty()) return;
    center_ = 0.5 * box.low + 0.5 * box.high;
    const double half = std::max(box.high.x - center_.x, box.high.y - center_.y);
    if (half > 0.0) step_ = std::ldexp(1.0, std::ilogb(half) - 39);
  }

  Clipper2Lib::Paths64 to_grid(const std::vector<Polygon>& polygons) const {
    Clipper2Lib::Paths64 paths;
    paths.reserve(polygons.size());
    for (const Polygon& polygon : polygons) {
      Clipper2Lib::Path64& path = paths.emplace_back();
      path.reserve(polygon.size());
      for (const Point2& point : polygon) {
        path.emplace_back(std::llround((point.x - center_.x) / step_),
                          std::llround((point.y - center_.y) / step_));
      }
    }
    return paths;
  }

  Point2 from_grid(const Clipper2Lib::Point64& point) const {
    return {center_.x + static_cast<double>(point.x) * step_,
            center_.y + static_cast<double>(point.y) * step_};
  }

 private:
  Point2 center_;
  double step_ = 1.0;
};

Clipper2Lib::FillRule clipper_rule(FillRule rule) {
  return rule == FillRule::kNonzero ? Clipper2Lib::FillRule::NonZero
                                    : Clipper2Lib::FillRule::EvenOdd;
}

Clipper2Lib::Paths64 resolved(const Clipper2Lib::Paths64& paths, FillRule rule) {
  Clipper2Lib::Clipper64 clipper;
  clipper.AddSubject(paths);
  Clipper2Lib::Paths64 result;
  clipper.Execute(Clipper2Lib::ClipType::Union, clipper_rule(rule), result);
  return result;
}

Clipper2Lib::ClipType clip_type(OutlineOperation operation) {
  switch (operation) {
    case OutlineOperation::kUnion:
      return Clipper2Lib::ClipType::Union;
    case OutlineOperation::kIntersection:
      return Clipper2Lib::ClipType::Intersection;
    case OutlineOperation::kDifference:
      break;
  }
  return Clipper2Lib::ClipType::Difference;
}

}  // namespace

std::vector<Polygon> flattened(const Outline& outline, double tolerance) {
  std::vector<Polygon> polygons;
  for (std::size_t c = 0; c < outline.contour_count(); ++c) {
    Polygon polygon;
    for (const Outline::Segment& segment : outline.contour(c)) {
      append_flattened(curve_of(outline, segment), tolerance, &polygon);
    }
    if (!polygon.empty() && !(polygon.back() == outline.begin_of(c))) {
      polygon.push_back(outline.begin_of(c));
    }
    if (polygon.size() > 2) polygons.push_back(std::move(polygon));
  }
  return polygons;
}

Outline combine_polygons(const std::vector<Polygon>& first, FillRule first_rule,
                         const std::vector<Polygon>& second, FillRule second_rule,
                         OutlineOperation operation) {
  const ClipGrid grid(first, second);
  Clipper2Lib::Paths64 subject = grid.to_grid(first);
  Clipper2Lib::Paths64 clip = grid.to_grid(second);
  if (first_rule != second_rule && !clip.empty()) {
    subject = resolved(subject, first_rule);
    clip = resolved(clip, second_rule);
    first_rule = FillRule::kNonzero;
  }
  Clipper2Lib::Clipper64 clipper;
  clipper.AddSubject(subject);
  clipper.AddClip(clip);
  Clipper2Lib::Paths64 paths;
  clipper.Execute(clip_type(operation), clipper_rule(first_rule), paths);

  Outline outline;
  for (const Clipper2Lib::Path64& path : paths) {
    if (path.size() < 3) continue;
    outline.move_to(grid.from_grid(path.front()));
    for (std::size_t i = 1; i < path.size(); ++i) outline.line_to(grid.from_grid(path[i]));
    outline.close();
  }
  return outline;
}

}  // namespace prefilter
