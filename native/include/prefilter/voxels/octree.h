// SPDX-License-Identifier: GPL-3.0-or-later

// Occupancy octrees: the share of each cell of a box that is inside a shape, refined at its
// surface.
#pragma once

#include <cstdint>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/wavelet/cell_tree.h"

namespace prefilter {

/// A triangle of a mesh at which the solid is thinner than requested. Lengths are in cells of the
/// octree's depth.
struct ThinTriangle {
  std::uint32_t triangle;
  double thickness;  // diameter of the inscribed ball of the solid there
  double made;       // diameter after thickening
  double area;       // area of the thin part of the triangle
};

/// The occupancies, in [0, 1], of the cells of a box; 0 outside the box.
struct Octree {
  CellTree cells;
  Box bounds;
  int depth = 0;  // finest possible cells: 2^depth along each axis
  // Nonzero in finest cells whose occupancy was raised because the mesh is thin there.
  CellTree thickened;
  // Thin triangles of the source mesh, in ascending order.
  std::vector<ThinTriangle> thin = {};  // thickness at the thinnest point of each
  // The same for walls alone, whose faces are nearly parallel, since wedges and tips taper to
  // nothing; 9/10 of the wall below each triangle is thicker than its thickness here.
  std::vector<ThinTriangle> thin_walls = {};

  /// The side of a cell at depth `at_depth`.
  double cell_size(int axis, int at_depth) const;
};

/// A copy whose finest cells are at this depth and hold the means of finer ones.
Octree coarsened(const Octree& octree, int depth);

/// Builds an octree from blocks; sets `first` and all means. Throws Error where the blocks form no
/// tree: a level does not have one block per split octant, a value is outside [0, 1], there are
/// more levels than `depth`, or `depth` or `bounds` are out of range.
Octree make_octree(std::vector<TreeLevel> levels, float root, const Box& bounds, int depth);

/// Throws Error that names the argument for a depth outside [low, kMaxTreeDepth].
void check_depth(int depth, int low, const char* argument);

}  // namespace prefilter
