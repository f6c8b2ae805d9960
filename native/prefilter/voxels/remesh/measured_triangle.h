// SPDX-License-Identifier: GPL-3.0-or-later

// Distances of points from triangles.
#pragma once

#include <algorithm>
#include <limits>

#include "prefilter/base/geometry.h"

namespace prefilter {

inline double squared_length(const Vector3& a) { return dot(a, a); }

inline double squared_distance_to_segment(const Vector3& p, const Vector3& a, const Vector3& b) {
  const Vector3 side = b - a;
  const double all = squared_length(side);
  const double along = all > 0.0 ? std::clamp(dot(p - a, side) / all, 0.0, 1.0) : 0.0;
  return squared_length(p - (a + along * side));
}

/// A triangle prepared for distance queries.
struct MeasuredTriangle {
  Vector3 a, b, c;
  Vector3 normal;
  double squared_normal;

  MeasuredTriangle() = default;
  MeasuredTriangle(const Vector3& p, const Vector3& q, const Vector3& r)
      : a(p), b(q), c(r), normal(cross(q - p, r - p)), squared_normal(squared_length(normal)) {}

  double squared_distance(const Vector3& p) const {
    const Vector3 pa = a - p;
    const Vector3 pb = b - p;
    const Vector3 pc = c - p;
    const double u = dot(normal, cross(pb, pc));
    const double v = dot(normal, cross(pc, pa));
    const double w = dot(normal, cross(pa, pb));
    if (u >= 0.0 && v >= 0.0 && w >= 0.0 && squared_normal > 0.0) {
      const double height = dot(normal, pa);
      return height * height / squared_normal;
    }
    double least = std::numeric_limits<double>::infinity();
    if (u < 0.0) least = std::min(least, squared_distance_to_segment(p, b, c));
    if (v < 0.0) least = std::min(least, squared_distance_to_segment(p, c, a));
    if (w < 0.0) least = std::min(least, squared_distance_to_segment(p, a, b));
    return least;
  }
};

}  // namespace prefilter
