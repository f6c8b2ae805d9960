// SPDX-License-Identifier: GPL-3.0-or-later

// Measures how the surface around a vertex bends.
#pragma once

#include <array>
#include <cstdint>

#include "prefilter/base/geometry.h"
#include "prefilter/voxels/remesh/patch.h"
#include "prefilter/voxels/remesh/patch_links.h"

namespace prefilter {

/// Properties of a ring of triangles before its vertex is removed. Two creases divide it into two
/// sectors; otherwise there is one.
struct RingShape {
  std::array<Vector3, kMaxNeighbors> normals;  // of length twice the area
  std::array<double, kMaxNeighbors> squared_normals;
  std::array<bool, kMaxNeighbors> is_sliver;
  std::array<std::uint8_t, kMaxNeighbors> sectors;
  std::array<Vector3, 2> sector_normals;  // unit; 0 if there is none
  /// Maxima over the triangles.
  double error = 0.0;
  double deviation = 0.0;
  bool has_points = false;
  /// Height of the ring along a sector's normal.
  double range = 0.0;
  /// Whether a sector has overlaps in projection along its normal, or is far from flat.
  bool is_bent = false;
  // the least squared height of a triangle, at most one squared tolerance
  double squared_height = 0.0;
};

void measure_ring(const Patch& patch, std::int32_t vertex, const Ring& ring, RingShape* shape);

/// Whether the edges to two neighbors border on a common sector.
inline bool share_sector(const Ring& ring, const RingShape& shape, std::size_t i, std::size_t j) {
  if (ring.crease_count < 2) return true;
  const std::uint8_t i_after = shape.sectors[i];
  const std::uint8_t i_before = shape.sectors[ring.before(i)];
  const std::uint8_t j_after = shape.sectors[j];
  const std::uint8_t j_before = shape.sectors[ring.before(j)];
  return i_after == j_after || i_after == j_before || i_before == j_after || i_before == j_before;
}

}  // namespace prefilter
