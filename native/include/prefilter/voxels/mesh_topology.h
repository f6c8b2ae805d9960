// SPDX-License-Identifier: GPL-3.0-or-later

// How many parts a mesh has, and how many cavities, handles and borders.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/base/progress.h"

namespace prefilter {

struct MeshTopology {
  std::size_t parts = 0;  // of triangles that hang together by edges
  // Of these: closed, all faces agree on which side is out, and that is within.
  std::size_t cavities = 0;
  std::size_t borders = 0;  // loops of edges with a single triangle
  // Of all parts together: half of what 2 - borders of each is above its Euler characteristic. None
  // where more than two triangles share an edge, or a surface has one side.
  std::optional<std::size_t> genus;
  // Edges with a single triangle, each from its vertex with the lower number.
  std::vector<std::array<std::int32_t, 2>> border_edges;
  std::vector<std::int32_t> part_of;  // of each triangle; -1 where two corners are one vertex
};

/// Parts that meet at a vertex alone are several. With `welds` vertices of borders that are at one
/// place count as one. The same for any number of threads. Throws Error for a mesh that is no mesh,
/// or of more than 2^31 - 1 corners; Error(kCancelled).
MeshTopology mesh_topology(const InputMesh& mesh, bool welds, const Progress& progress,
                           int threads);

}  // namespace prefilter
