// SPDX-License-Identifier: GPL-3.0-or-later

// Triangulates holes of few sides optimally.
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "prefilter/base/geometry.h"

namespace prefilter {

/// Maximum number of sides of a hole.
inline constexpr std::size_t kMaxRingSize = 12;

/// The squared sine of 16 degrees; narrower triangles have a fault.
inline constexpr float kMinWidth = static_cast<float>(0.2756373558169992 * 0.2756373558169992);

/// Fault of a triangle whose smallest angle has this squared sine: from 1 to 2 if it is narrow,
/// else 0.
inline double fault_of(double width) { return width < kMinWidth ? 2.0 - width / kMinWidth : 0.0; }

/// Triangles between points, with ascending indices; triangles behind a diagonal follow the one
/// before it.
struct RingTriangles {
  std::size_t count = 0;
  std::array<std::array<std::size_t, 3>, kMaxRingSize> triangles;
  double fault = 0.0;  // total
};

/// Finds the triangulation with the least total fault and, among those, the shortest sides relative
/// to areas, by dynamic programming (G. Klincsek, Minimal triangulations of polygonal domains,
/// 1980). All normals must have a cosine above `least` to `direction`, a unit vector; returns false
/// if there is no such triangulation. `unit` is 1 over an area, for scaling. Accepts 3 to
/// kMaxRingSize points.
bool triangulate_ring(std::span<const Vector3> points, const Vector3& direction, double unit,
                      double least, RingTriangles* result);

}  // namespace prefilter
