// SPDX-License-Identifier: GPL-3.0-or-later

// A contour before loops that edges of the shape cross become triangles.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "prefilter/base/geometry.h"

namespace prefilter {

/// Where vertices between cells go back to, in this order.
struct Crossings {
  std::vector<Vector3> fitted;  // before they were sampled
  std::vector<Vector3> plain;   // of two cells alone
  std::vector<Vector3> middle;  // halfway between the centers of cells: never folded

  /// Moves a vertex to the next of them; returns whether there is one.
  bool put_back(std::size_t v, Vector3* position) const {
    if (*position == middle[v]) return false;
    if (*position == plain[v]) {
      *position = middle[v];
    } else {
      *position = *position == fitted[v] ? plain[v] : fitted[v];
    }
    return true;
  }
};

/// A loop of a contour whose vertices are on different sides of an edge.
struct SharpLoop {
  std::array<std::int32_t, 12> corners;
  int count = 0;
  // Its triangles without the edge, among those of all sharp loops.
  std::size_t first = 0;
  std::size_t end = 0;

  std::int32_t from(std::size_t side) const { return corners[side]; }
  std::int32_t to(std::size_t side) const {
    return corners[(side + 1) % static_cast<std::size_t>(count)];
  }
};

/// A contour of which some loops have yet to become triangles.
struct LoopedMesh {
  std::vector<Vector3> positions;
  // Of all other loops.
  std::vector<std::array<std::int32_t, 3>> triangles;
  std::vector<SharpLoop> loops;
  std::vector<std::array<std::int32_t, 3>> loop_triangles;
};

}  // namespace prefilter
