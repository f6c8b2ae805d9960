// SPDX-License-Identifier: GPL-3.0-or-later

// Links from the vertices of a patch to the triangles around them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "prefilter/voxels/remesh/patch.h"

namespace prefilter {

/// Circular lists of the corners at each vertex; corner 3 t + i is corner i of triangle t.
struct PatchLinks {
  std::vector<std::int32_t> firsts;  // of each vertex; -1: none
  std::vector<std::int32_t> nexts;   // of each corner
  std::vector<std::int32_t> counts;  // of each vertex

  std::size_t count(std::int32_t vertex) const {
    return static_cast<std::size_t>(counts[as_index(vertex)]);
  }

  /// Calls visit(triangle, corner) for the corners at a vertex, which must have some.
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

/// Removes a triangle's corner from the list of a vertex, which must have others.
void drop_corner(std::int32_t vertex, std::int32_t triangle, PatchLinks* links);

/// Moves the corners of `from` to `to`; both must have some.
void move_corners(std::int32_t from, std::int32_t to, PatchLinks* links);

/// Vertices with more neighbors are never removed.
inline constexpr std::size_t kMaxNeighbors = 64;

/// The triangles around a vertex, counterclockwise: triangle i has neighbors i and i + 1.
struct Ring {
  std::size_t size = 0;
  std::array<std::int32_t, kMaxNeighbors> vertices;
  std::array<std::int32_t, kMaxNeighbors> triangles;
  std::array<std::uint8_t, kMaxNeighbors> corners;  // corner of each triangle at the vertex
  std::array<bool, kMaxNeighbors> is_crease;
  std::size_t crease_count = 0;

  std::size_t next(std::size_t i) const { return i + 1 == size ? 0 : i + 1; }
  std::size_t before(std::size_t i) const { return i == 0 ? size - 1 : i - 1; }
};

/// Returns false if the triangles do not form one closed fan, or are too many. `slots` is scratch
/// space with one entry per vertex.
bool find_ring(std::int32_t vertex, std::span<const PatchTriangle> triangles,
               const PatchLinks& links, std::vector<std::int32_t>* slots, Ring* ring);

}  // namespace prefilter
