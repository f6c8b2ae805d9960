// SPDX-License-Identifier: GPL-3.0-or-later

// Set operations by an arrangement of both outlines, with a fallback to clipped polygons.
#include "prefilter/shapes/set_operations.h"

#include <array>
#include <cmath>
#include <vector>

#include "prefilter/base/error.h"
#include "prefilter/shapes/outline/arrangement.h"
#include "prefilter/shapes/outline/fill_rule.h"
#include "prefilter/shapes/outline/polygon_clipper.h"

namespace prefilter {
namespace {

bool is_in_result(OutlineOperation operation, bool in_first, bool in_second) {
  switch (operation) {
    case OutlineOperation::kUnion:
      return in_first || in_second;
    case OutlineOperation::kIntersection:
      return in_first && in_second;
    case OutlineOperation::kDifference:
      break;
  }
  return in_first && !in_second;
}

// Products of differences of larger coordinates may overflow.
constexpr double kMaxCoordinate = 1e100;

void check_points(const Outline& outline) {
  for (const Point2& point : outline.points()) {
    if (!(std::abs(point.x) <= kMaxCoordinate && std::abs(point.y) <= kMaxCoordinate)) {
      throw_invalid("shapes: a point is not finite, or farther than 1e100 away");
    }
  }
}

}  // namespace

Outline combine(const Outline& first, FillRule first_rule, const Outline& second,
                FillRule second_rule, OutlineOperation operation, double tolerance) {
  check_points(first);
  check_points(second);
  const std::array<const Outline*, 2> outlines = {&first, &second};
  const auto is_inside = [&](const LayerWindings& windings) {
    return is_in_result(operation, is_filled(windings[0], first_rule),
                        is_filled(windings[1], second_rule));
  };
  for (const double precision : kArrangementPrecisions) {
    Arrangement arrangement(outlines, precision);
    if (arrangement.cut(ArrangementEffort::kUnbounded) != CutOutcome::kCut) continue;
    std::vector<BoundaryChain> boundary;
    arrangement.visit(
        0, arrangement.chain_count(),
        [&](std::uint32_t chain, const LayerWindings& right, const LayerWindings& left) {
          const bool is_right = is_inside(right);
          if (is_right != is_inside(left)) boundary.push_back({chain, is_right});
        });
    Outline result;
    if (arrangement.trace(boundary, &result)) return result;
  }
  return combine_polygons(flattened(first, tolerance), first_rule, flattened(second, tolerance),
                          second_rule, operation);
}

}  // namespace prefilter
