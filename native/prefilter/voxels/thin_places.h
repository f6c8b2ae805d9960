// SPDX-License-Identifier: GPL-3.0-or-later

// Where a solid is thinner than its cells can show.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/base/progress.h"
#include "prefilter/geometry/spatial/winding_numbers.h"
#include "prefilter/voxels/representatives.h"

namespace prefilter {

/// What is within a radius of a triangle in the middle of the solid.
struct ThickPiece {
  std::array<Vector3, 3> middles;
  double radius;
  std::uint32_t triangle;  // of the mesh, that it is below
  double thickness;        // of the solid there
  double area;             // of the triangle, that it is below
  bool is_wall;            // whether the faces of the solid are nearly parallel there
};

/// The pieces, the triangles that are as thin as others, and the mesh's winding numbers; these are
/// missing where nothing of it is across from anything.
struct ThickPieces {
  std::vector<ThickPiece> pieces;
  std::vector<Represented> others;
  std::unique_ptr<const WindingNumbers> winding;
};

/// Pieces that, added to a closed mesh, make it as thick as `thickness` where it is thinner and in
/// a box; lengths are cells. Rods and specks get more, by as much as cells need to hold them
/// together. The medial balls of Ma, Bae, Choi, "3D medial point approximation using nearest
/// neighbors and the normal field" (2012), that touch what faces the other way: what is rough, or
/// an edge, is not thin. `occupancy(point)` is that of the cell that holds a point.
ThickPieces thick_pieces(const MeshView<std::int32_t>& mesh, double thickness, const Box& bounds,
                         const std::function<float(const Vector3&)>& occupancy,
                         const Progress& progress, int threads);

}  // namespace prefilter
