// SPDX-License-Identifier: GPL-3.0-or-later

// How the surface around a vertex bends.
#pragma once

#include <array>
#include <cstdint>

#include "prefilter/base/geometry.h"
#include "prefilter/voxels/remesh/patch.h"
#include "prefilter/voxels/remesh/patch_links.h"

namespace prefilter {

/// Of the triangles of a ring, before its vertex goes. Two creases divide it into sectors; with any
/// other number there is one.
struct RingShape {
  std::array<Vector3, kMostNeighbors> normals;  // twice as long as areas
  std::array<double, kMostNeighbors> squared_normals;
  std::array<bool, kMostNeighbors> is_sliver;
  std::array<std::uint8_t, kMostNeighbors> sectors;
  std::array<Vector3, 2> sector_normals;  // unit; 0 where there is none
  /// The largest of the triangles'.
  double error = 0.0;
  double deviation = 0.0;
  bool has_points = false;
  /// How high the ring is along the normal of a sector.
  double range = 0.0;
  /// A sector is not seen as a whole along its normal, or is far from flat.
  bool is_bent = false;
  double squared_height = 0.0;  // the least of a triangle, at most that of one tolerance
};

void measure_ring(const Patch& patch, std::int32_t vertex, const Ring& ring, RingShape* shape);

/// Whether the edges to two neighbors are on one side of a crease.
inline bool share_sector(const Ring& ring, const RingShape& shape, std::size_t i, std::size_t j) {
  if (ring.crease_count < 2) return true;
  const std::uint8_t i_after = shape.sectors[i];
  const std::uint8_t i_before = shape.sectors[ring.before(i)];
  const std::uint8_t j_after = shape.sectors[j];
  const std::uint8_t j_before = shape.sectors[ring.before(j)];
  return i_after == j_after || i_after == j_before || i_before == j_after || i_before == j_before;
}

}  // namespace prefilter
