// SPDX-License-Identifier: GPL-3.0-or-later

// The edges of a mesh, and the edge at each corner of a triangle.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/base/run.h"

namespace prefilter {

struct MeshEdges {
  // Each edge once, the lower vertex index first, in ascending order.
  std::vector<std::array<std::int32_t, 2>> vertices;
  // The edge from corner 3 t + i to the next corner of triangle t; -1 where both are the same
  // vertex.
  std::vector<std::int32_t> of_corners;
};

/// The result does not depend on the number of threads. Throws Error for an invalid mesh, or one of
/// more than 2^31 - 1 corners; Error(kCancelled).
MeshEdges find_mesh_edges(const InputMesh& mesh, const Run& run);

}  // namespace prefilter
