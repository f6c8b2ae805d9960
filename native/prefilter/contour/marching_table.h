// How a surface passes through a cube of eight samples: marching cubes, from a rule.
//
// Corner i of the cube is high along x where bit 0 of i is set, along y for bit 1, along z for bit
// 2. Edge 4 a + k runs along axis a; bit 0 of k tells its side along axis (a + 1) % 3, bit 1 that
// along axis (a + 2) % 3.
//
// On a face the segments depend on the signs of its four corners alone: each run of inside corners
// around the face is cut off by itself. Neighbours see the same segments, in opposite directions,
// so the surface is closed. A loop of segments is triangulated without diagonals in faces of the
// cube: such a one could be a diagonal, or a segment, of the neighbour's too, and belong to four
// triangles.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace prefilter {

/// The edges that a loop passes through; seen from outside, counter-clockwise.
using MarchingLoop = std::vector<std::uint8_t>;

struct MarchingCase {
  std::vector<MarchingLoop> loops;
  // The loops' triangles, as edges.
  std::vector<std::array<std::uint8_t, 3>> triangles;
  // The faces with two inside corners that are opposite of each other, as bits: 2 a for the low
  // face across axis a, 2 a + 1 for the high one.
  unsigned ambiguous_faces = 0;
};

/// The case of each set of inside corners (bit i: corner i).
const std::array<MarchingCase, 256>& marching_cases();

/// The loops of a set of inside corners. On the ambiguous faces given as bits the inside corners
/// are joined, and the outside ones cut off by themselves.
std::vector<MarchingLoop> marching_loops(unsigned inside, unsigned joined_faces);

/// The corners of a face, counter-clockwise seen from outside of the cube.
std::array<int, 4> face_corners(int axis, bool is_high);

/// The corner of an edge that is low along it.
constexpr int low_corner(int edge) {
  const int axis = edge / 4;
  const int k = edge % 4;
  return ((k & 1) << ((axis + 1) % 3)) | ((k >> 1) << ((axis + 2) % 3));
}
constexpr int high_corner(int edge) { return low_corner(edge) | (1 << (edge / 4)); }

/// The faces that an edge lies in, as bits.
constexpr unsigned faces_of_edge(int edge) {
  unsigned faces = 0;
  for (int axis = 0; axis < 3; ++axis) {
    if (axis == edge / 4) continue;
    faces |= 1U << (2 * axis + ((low_corner(edge) >> axis) & 1));
  }
  return faces;
}

/// Triangulates a loop of `count` vertices without the diagonals that `is_allowed(i, j)` refuses.
/// Appends triples of places in the loop; false, and nothing appended, where there is no way.
template <typename IsAllowed>
bool triangulate_loop(int count, const IsAllowed& is_allowed,
                      std::vector<std::array<std::uint8_t, 3>>* triangles) {
  // apex[i][j]: the third corner over the side (i, j) of a triangulation of i .. j; -1: none. Of
  // several the one nearest to the middle, for triangles that are not thin.
  constexpr int kMost = 12;
  std::array<std::array<std::int8_t, kMost>, kMost> apex{};
  for (int span = 2; span < count; ++span) {
    for (int i = 0; i + span < count; ++i) {
      const int j = i + span;
      apex[i][j] = -1;
      const bool is_side = span == count - 1;
      if (!is_side && !is_allowed(i, j)) continue;
      int best = 2 * kMost;
      for (int k = i + 1; k < j; ++k) {
        const bool low_is_fine = k == i + 1 || apex[i][k] >= 0;
        const bool high_is_fine = k == j - 1 || apex[k][j] >= 0;
        const int off_middle = k - i > j - k ? (k - i) - (j - k) : (j - k) - (k - i);
        if (low_is_fine && high_is_fine && off_middle < best) {
          best = off_middle;
          apex[i][j] = static_cast<std::int8_t>(k);
        }
      }
    }
  }
  if (count < 3 || apex[0][count - 1] < 0) return count < 3;
  std::vector<std::array<int, 2>> open = {{0, count - 1}};
  while (!open.empty()) {
    const auto [i, j] = open.back();
    open.pop_back();
    if (j - i < 2) continue;
    const int k = apex[i][j];
    triangles->push_back(
        {static_cast<std::uint8_t>(i), static_cast<std::uint8_t>(k), static_cast<std::uint8_t>(j)});
    open.push_back({i, k});
    open.push_back({k, j});
  }
  return true;
}

}  // namespace prefilter
