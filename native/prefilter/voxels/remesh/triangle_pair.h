// SPDX-License-Identifier: GPL-3.0-or-later

// Tests two triangles for intersection.
#pragma once

#include <array>
#include <cstdint>

#include "prefilter/base/geometry.h"

namespace prefilter {

/// A triangle's corners and their vertex indices.
struct Corners {
  std::array<Vector3, 3> points;
  std::array<std::int32_t, 3> vertices;
};

/// Whether two triangles intersect beyond the vertices and edges that they share. Decided without
/// rounding errors, for coordinates as plane_side requires. Neither triangle may be degenerate.
bool do_intersect(const Corners& a, const Corners& b);

}  // namespace prefilter
