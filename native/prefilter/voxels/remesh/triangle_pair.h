// SPDX-License-Identifier: GPL-3.0-or-later

// Two triangles in space.
#pragma once

#include <array>
#include <cstdint>

#include "prefilter/base/geometry.h"

namespace prefilter {

/// A triangle as its corners, and the vertices that these are.
struct Corners {
  std::array<Vector3, 3> points;
  std::array<std::int32_t, 3> vertices;
};

/// Whether two triangles have more points in common than the vertices and edges that they share.
/// Decided without rounding errors, for coordinates as plane_side asks for. The corners of neither
/// may be on one line.
bool do_intersect(const Corners& a, const Corners& b);

}  // namespace prefilter
