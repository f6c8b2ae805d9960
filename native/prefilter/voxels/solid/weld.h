// SPDX-License-Identifier: GPL-3.0-or-later

// Vertices that count as one, and faces that are there more than once.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/base/progress.h"

namespace prefilter {

/// A mesh in the making: vertices are the input's, and where there are more, new ones.
struct WorkMesh {
  std::vector<Vector3> positions;
  std::vector<std::array<std::int32_t, 3>> triangles;
  std::vector<std::int64_t>
      origins;  // of each triangle: that of the input which it came from, or -1

  MeshView<std::int32_t> view() const { return {positions, triangles}; }
  std::array<Vector3, 3> corners(std::size_t triangle) const { return view().corners(triangle); }
};

/// For each vertex, the first of those at its place.
std::vector<std::int32_t> first_at_each_place(const PositionView& positions,
                                              const Progress& progress, int threads);

/// Lets triangles name the first of the vertices at each place. Returns how many other vertices are
/// not named any more.
std::size_t weld_equal(WorkMesh* mesh, const Progress& progress, int threads);

/// Welds the ends of edges that have one triangle, where they are no further apart than `distance`
/// and than a third of the shortest edge at either: so a triangle keeps its corners, and a border
/// its vertices. Of those welded the first stays in its place. Returns how many others there were.
std::size_t weld_borders(WorkMesh* mesh, double distance, const Progress& progress, int threads);

/// Splits edges that have one triangle at ends of others that are no further away than `distance`,
/// and further than that from its own: where finer borders meet coarser ones. Returns at how many
/// places.
std::size_t split_borders(WorkMesh* mesh, double distance, const Progress& progress, int threads);

/// Removes triangles that name a vertex twice, and of those with the same three vertices all but
/// the first of the direction that more of them have. Returns how many of the latter were removed.
std::size_t drop_duplicates(WorkMesh* mesh, const Progress& progress, int threads);

}  // namespace prefilter
