// SPDX-License-Identifier: GPL-3.0-or-later

// Occupancy octrees: how much of each cell of a box is inside of a shape, finely along its surface.
#pragma once

#include <cstdint>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/wavelet/cell_tree.h"

namespace prefilter {

/// A triangle of a mesh below which the solid was thinner than asked for, at one of its places.
/// Lengths are cells of the octree's depth.
struct ThinTriangle {
  std::uint32_t triangle;
  double thickness;  // of the solid there: the diameter of the ball in it
  double made;       // the diameter that it got
  double area;       // of the triangle, as far as it is thin
};

/// The occupancies, in [0, 1], of the cells of a box. What is outside of the box is empty.
struct Octree {
  CellTree cells;
  Box bounds;
  int depth = 0;  // 2^depth cells along each axis are the finest that there may be
  // Above 0 in the finest cells that are fuller than the mesh, as it is thin there.
  CellTree thickened;
  // Of the mesh that it was made of, in ascending order.
  std::vector<ThinTriangle> thin = {};  // where each is thinnest
  // Likewise, of walls alone, whose faces are nearly parallel: wedges and tips end in nothing.
  // Where nine tenths of the wall below each are thicker.
  std::vector<ThinTriangle> thin_walls = {};

  /// The side of a cell of this depth.
  double cell_size(int axis, int at_depth) const;
};

/// A copy whose finest cells are of this depth: means of what was finer.
Octree coarsened(const Octree& octree, int depth);

/// An octree with these blocks, with `first` and all means set. Throws Error where they are no
/// tree: a level has not a block for each octant that is split, a value is not in [0, 1], there are
/// more levels than `depth`, or `depth` or `bounds` are out of range.
Octree make_octree(std::vector<TreeLevel> levels, float root, const Box& bounds, int depth);

/// Throws Error, with the name of the argument, for a depth out of [low, kMaxTreeDepth].
void check_depth(int depth, int low, const char* argument);

}  // namespace prefilter
