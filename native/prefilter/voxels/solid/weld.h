// SPDX-License-Identifier: GPL-3.0-or-later

// Welds vertices and drops duplicate faces.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/base/run.h"

namespace prefilter {

/// A mesh under repair: the input's vertices, followed by new ones.
struct WorkMesh {
  std::vector<Vector3> positions;
  std::vector<std::array<std::int32_t, 3>> triangles;
  std::vector<std::int64_t> origins;  // input triangle of each triangle, or -1

  MeshView<std::int32_t> view() const { return {positions, triangles}; }
  std::array<Vector3, 3> corners(std::size_t triangle) const { return view().corners(triangle); }
};

/// For each vertex, the first one at the same position.
std::vector<std::int32_t> first_at_position(const PositionView& positions, const Run& run);

/// Replaces vertices by the first one at the same position. Returns the number of vertices that are
/// no longer used.
std::size_t weld_equal(WorkMesh* mesh, const Run& run);

/// Welds boundary vertices that are no farther apart than `distance`, nor than a third of the
/// shortest edge at either, so that no triangle or border collapses. The first of each group keeps
/// its position. Returns the number of vertices replaced.
std::size_t weld_borders(WorkMesh* mesh, double distance, const Run& run);

/// Splits boundary edges at boundary vertices within `distance` that are farther than that from the
/// edge's ends, where fine borders meet coarse ones. Returns the number of splits.
std::size_t split_borders(WorkMesh* mesh, double distance, const Run& run);

/// Removes triangles with repeated vertices and, among triangles with the same three vertices, all
/// except the first of the more frequent direction. Returns the number of the latter.
std::size_t drop_duplicates(WorkMesh* mesh, const Run& run);

}  // namespace prefilter
