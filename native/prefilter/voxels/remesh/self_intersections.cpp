// SPDX-License-Identifier: GPL-3.0-or-later

// Finds self-intersections of meshes of any index type.
#include "prefilter/voxels/self_intersections.h"

#include <algorithm>
#include <limits>

#include "prefilter/base/error.h"
#include "prefilter/voxels/remesh/intersections.h"

namespace prefilter {

std::vector<std::array<std::uint32_t, 2>> self_intersections(const InputMesh& mesh,
                                                             const Run& run) {
  check_mesh(mesh, kLargestCoordinate);
  constexpr auto kMostVertices = static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max());
  if (mesh.positions.size() > kMostVertices) {
    throw_invalid("positions: 2^31 vertices or more");
  }
  std::vector<Vector3> positions;
  positions.reserve(mesh.positions.size());
  for (std::size_t k = 0; k < mesh.positions.size(); ++k) positions.push_back(mesh.positions[k]);
  std::vector<std::array<std::int32_t, 3>> triangles;
  triangles.reserve(mesh.triangles.size());
  for (std::size_t k = 0; k < mesh.triangles.size(); ++k) {
    const auto [a, b, c] = mesh.triangles[k];
    triangles.push_back(
        {static_cast<std::int32_t>(a), static_cast<std::int32_t>(b), static_cast<std::int32_t>(c)});
  }
  auto pairs = intersecting_triangles({positions, triangles}, {}, run);
  // intersecting_triangles pairs a triangle without area with itself.
  std::erase_if(pairs, [](const auto& pair) { return pair[0] == pair[1]; });
  return pairs;
}

}  // namespace prefilter
