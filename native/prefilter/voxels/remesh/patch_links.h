// SPDX-License-Identifier: GPL-3.0-or-later

// Which triangles of a patch are around its vertices.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "prefilter/voxels/remesh/patch.h"

namespace prefilter {

/// The corners of each vertex in a circle: corner 3 t + i is that of triangle t at place i.
struct PatchLinks {
  std::vector<std::int32_t> firsts;  // of each vertex; -1: none
  std::vector<std::int32_t> nexts;   // of each corner
  std::vector<std::int32_t> counts;  // of each vertex

  std::size_t count(std::int32_t vertex) const {
    return static_cast<std::size_t>(counts[as_index(vertex)]);
  }

  /// Calls visit(triangle, place) for the corners of a vertex that has some.
  template <typename Visit>
  void for_corners(std::int32_t vertex, const Visit& visit) const {
    const std::int32_t first = firsts[as_index(vertex)];
    std::int32_t corner = first;
    do {
      visit(corner / 3, corner % 3);
      corner = nexts[as_index(corner)];
    } while (corner != first);
  }
};

PatchLinks link_corners(std::size_t vertex_count, std::span<const PatchTriangle> triangles);

/// Takes the corner that a vertex has of a triangle out of its circle; it has others.
void drop_corner(std::int32_t vertex, std::int32_t triangle, PatchLinks* links);

/// The corners of `from` become those of `to`; each has some.
void move_corners(std::int32_t from, std::int32_t to, PatchLinks* links);

/// Vertices with more neighbors than this stay.
inline constexpr std::size_t kMostNeighbors = 64;

/// The triangles around a vertex, counter-clockwise: triangle i has the neighbors i and i + 1.
struct Ring {
  std::size_t size = 0;
  std::array<std::int32_t, kMostNeighbors> vertices;
  std::array<std::int32_t, kMostNeighbors> triangles;
  std::array<std::uint8_t, kMostNeighbors> corners;  // of the triangles, where the vertex is
  std::array<bool, kMostNeighbors> is_crease;
  std::size_t crease_count = 0;

  std::size_t next(std::size_t i) const { return i + 1 == size ? 0 : i + 1; }
  std::size_t before(std::size_t i) const { return i == 0 ? size - 1 : i - 1; }
};

/// Returns false where the triangles are not one closed fan, or too many. `slots` has a place for
/// each vertex, and is left with anything in it.
bool find_ring(std::int32_t vertex, std::span<const PatchTriangle> triangles,
               const PatchLinks& links, std::vector<std::int32_t>* slots, Ring* ring);

}  // namespace prefilter
