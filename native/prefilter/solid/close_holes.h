// Caps for the holes of a mesh.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/base/progress.h"

namespace prefilter {

/// Triangles that close a mesh, and the vertices that they need.
struct Caps {
  std::vector<Vector3> positions;  // numbered on from the mesh's own
  std::vector<std::array<std::int64_t, 3>> triangles;
  std::size_t open_edges = 0;  // unbalanced: traversed more often in one direction
  std::size_t holes = 0;       // loops of such edges
};

/// A fan around the middle of every loop of open edges, so that with them each edge is run through
/// as often one way as the other, and winding numbers are whole everywhere. Vertices at one place
/// count as one. Where faces are turned against their neighbours, the border between them counts
/// twice, and two fans set the winding right but for what lies between them and the faces.
///
/// Throws as voxelize does for a mesh that is no mesh; Error(kCancelled).
Caps close_holes(const InputMesh& mesh, const Progress& progress, int threads);

}  // namespace prefilter
