// SPDX-License-Identifier: GPL-3.0-or-later

// Counts the parts, cavities, handles and boundary loops of a mesh.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/base/run.h"

namespace prefilter {

struct MeshTopology {
  std::size_t parts = 0;  // components of triangles connected by edges
  // Parts that are closed, consistently oriented, and oriented inward.
  std::size_t cavities = 0;
  std::size_t borders = 0;  // boundary loops: edges with a single triangle
  // Total genus: half the sum, over all parts, of 2 - borders - Euler characteristic. None where
  // more than two triangles share an edge, or a surface is one-sided.
  std::optional<std::size_t> genus;
  // Edges with a single triangle, the lower vertex index first.
  std::vector<std::array<std::int32_t, 2>> border_edges;
  // part of each triangle; -1 where two corners are the same vertex
  std::vector<std::int32_t> part_of;
};

/// Parts that share only a vertex are separate. With `welds`, boundary vertices with equal
/// positions count as one. The result does not depend on the number of threads. Throws Error for an
/// invalid mesh, or one of more than 2^31 - 1 corners; Error(kCancelled).
MeshTopology mesh_topology(const InputMesh& mesh, bool welds, const Run& run);

}  // namespace prefilter
