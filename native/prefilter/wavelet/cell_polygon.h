// SPDX-License-Identifier: GPL-3.0-or-later

// Convex polygons in space, cut along a grid of unit cells.
#pragma once

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include "prefilter/base/geometry.h"

namespace prefilter {

/// A triangle clipped by axis-aligned planes: consecutive corners that are coplanar up to rounding.
struct CellPolygon {
  // A triangle clipped by the six sides of a box has at most nine.
  static constexpr int kMaxCorners = 10;
  std::array<Vector3, kMaxCorners> corners;
  int count = 0;

  void add(const Vector3& corner) {
    assert(count < kMaxCorners);
    corners[count++] = corner;
  }
  double lowest(int axis) const {
    double low = corners[0][axis];
    for (int i = 1; i < count; ++i) low = std::min(low, corners[i][axis]);
    return low;
  }
  double highest(int axis) const {
    double high = corners[0][axis];
    for (int i = 1; i < count; ++i) high = std::max(high, corners[i][axis]);
    return high;
  }
};

/// Splits a polygon at a plane across an axis. Corners on the plane belong to both parts.
inline void split_polygon(const CellPolygon& polygon, int axis, double value, CellPolygon* low,
                          CellPolygon* high) {
  low->count = 0;
  high->count = 0;
  const Vector3* previous = &polygon.corners[polygon.count - 1];
  double previous_side = (*previous)[axis] - value;
  for (int i = 0; i < polygon.count; ++i) {
    const Vector3& corner = polygon.corners[i];
    const double side = corner[axis] - value;
    if ((previous_side < 0.0 && side > 0.0) || (previous_side > 0.0 && side < 0.0)) {
      const double t = previous_side / (previous_side - side);
      Vector3 cut;
      for (int a = 0; a < 3; ++a) cut[a] = (*previous)[a] + t * (corner[a] - (*previous)[a]);
      cut[axis] = value;
      low->add(cut);
      high->add(cut);
    }
    if (side <= 0.0) low->add(corner);
    if (side >= 0.0) high->add(corner);
    previous = &corner;
    previous_side = side;
  }
}

/// The cells [low, high) along each axis.
struct CellBox {
  std::array<int, 3> low;
  std::array<int, 3> high;
};

/// Clips a polygon to [low, high] along an axis; empty if no area is left.
inline void clip_to_slab(int axis, double low, double high, CellPolygon* polygon) {
  CellPolygon inside;
  CellPolygon outside;
  if (polygon->lowest(axis) < low) {
    split_polygon(*polygon, axis, low, &outside, &inside);
    *polygon = inside;
  }
  if (polygon->count > 2 && polygon->highest(axis) > high) {
    split_polygon(*polygon, axis, high, &inside, &outside);
    *polygon = inside;
  }
  if (polygon->count < 3) polygon->count = 0;
}

namespace cut_detail {

template <int kAxis, typename Visit>
void cut(const CellPolygon& polygon, const CellBox& box, std::array<int, 3>* cell,
         const Visit& visit) {
  if constexpr (kAxis == 3) {
    visit(*cell, polygon);
  } else {
    const int last_cell = box.high[kAxis] - 1;
    const double low = polygon.lowest(kAxis);
    const double high = polygon.highest(kAxis);
    const int first = std::clamp(static_cast<int>(std::floor(low)), box.low[kAxis], last_cell);
    const int last = std::clamp(static_cast<int>(std::ceil(high)) - 1, first, last_cell);
    if (first == last) {
      (*cell)[kAxis] = first;
      cut<kAxis + 1>(polygon, box, cell, visit);
      return;
    }
    CellPolygon piece;
    std::array<CellPolygon, 2> rest;
    const CellPolygon* remaining = &polygon;
    for (int i = first; i < last; ++i) {
      CellPolygon* above = &rest[i & 1];
      split_polygon(*remaining, kAxis, i + 1.0, &piece, above);
      remaining = above;
      if (piece.count > 2) {
        (*cell)[kAxis] = i;
        cut<kAxis + 1>(piece, box, cell, visit);
      }
      if (above->count < 3) return;
    }
    (*cell)[kAxis] = last;
    cut<kAxis + 1>(*remaining, box, cell, visit);
  }
}

}  // namespace cut_detail

/// Calls visit(cell, polygon) for every cell that the polygon intersects. The polygon must lie
/// within the box. Parts exactly between two cells belong to one of them.
template <typename Visit>
void cut_polygon(const CellPolygon& polygon, const CellBox& box, const Visit& visit) {
  std::array<int, 3> cell{};
  cut_detail::cut<0>(polygon, box, &cell, visit);
}

}  // namespace prefilter
