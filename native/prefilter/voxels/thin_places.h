// SPDX-License-Identifier: GPL-3.0-or-later

// Finds where a solid is thinner than its cells can represent.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/base/run.h"
#include "prefilter/geometry/spatial/winding_numbers.h"
#include "prefilter/voxels/representatives.h"

namespace prefilter {

/// All points within a radius of a triangle on the medial surface of the solid.
struct ThickPiece {
  std::array<Vector3, 3> middles;
  double radius;
  std::uint32_t triangle;  // the mesh's triangle above it
  double thickness;        // of the solid there
  double area;             // of the triangle above it
  bool is_wall;            // whether the solid's faces are nearly parallel there
};

/// The pieces, the triangles that are as thin as their representatives, and the mesh's winding
/// numbers, which are unset if no surfaces are opposed.
struct ThickPieces {
  std::vector<ThickPiece> pieces;
  std::vector<Represented> others;
  std::unique_ptr<const WindingNumbers> winding;
};

/// Pieces that thicken a closed mesh to `thickness` where it is thinner, within a box; lengths are
/// in cells. Rods and specks get more, as needed for cells to hold them together. Based on the
/// medial balls of J. Ma, S. W. Bae, S. Choi, 3D medial point approximation using nearest neighbors
/// and the normal field (2012), restricted to opposed surfaces, so that roughness and edges do not
/// count as thin. `occupancy(point)` returns the occupancy of the cell that contains a point.
ThickPieces thick_pieces(const MeshView<std::int32_t>& mesh, double thickness, const Box& bounds,
                         const std::function<float(const Vector3&)>& occupancy, const Run& run);

}  // namespace prefilter
