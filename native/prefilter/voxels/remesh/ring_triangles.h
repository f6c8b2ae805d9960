// SPDX-License-Identifier: GPL-3.0-or-later

// Holes of few sides filled by the best triangles.
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "prefilter/base/geometry.h"

namespace prefilter {

/// The most sides that a hole may have.
inline constexpr std::size_t kMostAround = 12;

/// The square of the sine of 16 degrees: triangles that are narrower have a fault.
inline constexpr float kNarrow = static_cast<float>(0.2756373558169992 * 0.2756373558169992);

/// Of a triangle whose smallest angle has this squared sine: from 1 to 2 where it is narrow.
inline double fault_of(double width) { return width < kNarrow ? 2.0 - width / kNarrow : 0.0; }

/// Triangles between points by their numbers, which rise, those behind a diagonal after the one
/// before it.
struct RingTriangles {
  std::size_t count = 0;
  std::array<std::array<std::size_t, 3>, kMostAround> triangles;
  double fault = 0.0;  // of all
};

/// The triangles with the fewest and least faults, and of these the ones with the shortest sides
/// for their areas, by dynamic programming (Klincsek 1980). All have normals that are with a
/// cosine of more than `least` along `direction`, of length 1; false where there are none such.
/// `unit` is 1 over an area, for scale. 3 to kMostAround points.
bool triangulate_ring(std::span<const Vector3> points, const Vector3& direction, double unit,
                      double least, RingTriangles* found);

}  // namespace prefilter
