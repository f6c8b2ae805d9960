// SPDX-License-Identifier: GPL-3.0-or-later

// The edges of a mesh, and which of them runs from each corner of a triangle.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/base/progress.h"

namespace prefilter {

struct MeshEdges {
  // Each edge once, from its vertex with the lower number to the other, in ascending order.
  std::vector<std::array<std::int32_t, 2>> vertices;
  // The edge from the corner 3 t + i to the next one of triangle t; -1 where both are one vertex.
  std::vector<std::int32_t> of_corners;
};

/// The same for any number of threads. Throws Error for a mesh that is no mesh, or of more than
/// 2^31 - 1 corners; Error(kCancelled).
MeshEdges find_mesh_edges(const InputMesh& mesh, const Progress& progress, int threads);

}  // namespace prefilter
