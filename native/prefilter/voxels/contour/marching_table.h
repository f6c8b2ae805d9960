// SPDX-License-Identifier: GPL-3.0-or-later

// Generates the cases of marching cubes from a rule.
//
// Corner i of the cube is high along x if bit 0 of i is set, along y for bit 1, along z for bit 2.
// Edge 4 a + k runs along axis a; bit 0 of k is its side along axis (a + 1) % 3, bit 1 its side
// along axis (a + 2) % 3.
//
// The segments on a face depend on the signs of its four corners alone: each run of inside corners
// around the face is cut off separately. Neighbors have the same segments, in opposite directions,
// so the surface is closed. Diagonals of a loop must not lie in faces of the cube: they could also
// be a diagonal or a segment of the neighbor, and belong to four triangles.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace prefilter {

/// The edges that a loop passes through, counterclockwise seen from outside.
using MarchingLoop = std::vector<std::uint8_t>;

struct MarchingCase {
  std::vector<MarchingLoop> loops;
  // Bit mask of the faces with two diagonally opposite inside corners: 2 a for the low face across
  // axis a, 2 a + 1 for the high one.
  unsigned ambiguous_faces = 0;
};

/// The case for each set of inside corners (bit i: corner i).
const std::array<MarchingCase, 256>& marching_cases();

/// The loops of a set of inside corners. On the ambiguous faces in `joined_faces` the inside
/// corners are joined, and the outside corners cut off.
std::vector<MarchingLoop> marching_loops(unsigned inside, unsigned joined_faces);

/// The corners of a face, counterclockwise seen from outside the cube.
std::array<int, 4> face_corners(int axis, bool is_high);

/// The corner at the low end of an edge.
constexpr int low_corner(int edge) {
  const int axis = edge / 4;
  const int k = edge % 4;
  return ((k & 1) << ((axis + 1) % 3)) | ((k >> 1) << ((axis + 2) % 3));
}
constexpr int high_corner(int edge) { return low_corner(edge) | (1 << (edge / 4)); }

/// Bit mask of the faces in which an edge lies.
constexpr unsigned faces_of_edge(int edge) {
  unsigned faces = 0;
  for (int axis = 0; axis < 3; ++axis) {
    if (axis == edge / 4) continue;
    faces |= 1U << (2 * axis + ((low_corner(edge) >> axis) & 1));
  }
  return faces;
}

/// Triangulates a loop of 3 to 12 vertices without the diagonals that `is_allowed(i, j)` rejects,
/// minimizing the sum of `cost(i, j, k)` over its triangles. Calls `add(i, j, k)` with their
/// indices in the loop; returns false, without calls, if there is no triangulation.
template <typename IsAllowed, typename Cost, typename Add>
bool triangulate_loop(int count, const IsAllowed& is_allowed, const Cost& cost, const Add& add) {
  if (count == 3) {
    add(0, 1, 2);
    return true;
  }
  constexpr int kMost = 12;
  // Best triangulation of i .. j: its cost, and the third corner of the triangle at side (i, j).
  std::array<std::array<double, kMost>, kMost> least;
  std::array<std::array<std::int8_t, kMost>, kMost> apex;
  for (int i = 0; i + 1 < count; ++i) least[i][i + 1] = 0.0;
  for (int span = 2; span < count; ++span) {
    for (int i = 0; i + span < count; ++i) {
      const int j = i + span;
      least[i][j] = std::numeric_limits<double>::infinity();
      apex[i][j] = -1;
      if (span < count - 1 && !is_allowed(i, j)) continue;
      for (int k = i + 1; k < j; ++k) {
        const double sides = least[i][k] + least[k][j];
        if (!(sides < least[i][j])) continue;
        const double sum = sides + cost(i, k, j);
        if (apex[i][j] >= 0 && sum >= least[i][j]) continue;
        least[i][j] = sum;
        apex[i][j] = static_cast<std::int8_t>(k);
      }
    }
  }
  if (apex[0][count - 1] < 0) return false;
  std::array<std::array<int, 2>, kMost> open;
  std::size_t waiting = 0;
  open[waiting++] = {0, count - 1};
  while (waiting > 0) {
    const auto [i, j] = open[--waiting];
    if (j - i < 2) continue;
    const int k = apex[i][j];
    add(i, k, j);
    open[waiting++] = {i, k};
    open[waiting++] = {k, j};
  }
  return true;
}

}  // namespace prefilter
