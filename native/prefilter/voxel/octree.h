// Occupancy octrees: how much of each cell of a box is inside of a shape, finely along its surface.
#pragma once

#include <array>
#include <vector>

#include "prefilter/wavelet/cell_tree.h"

namespace prefilter {

/// A box along the axes; each side is positive.
struct Box {
  std::array<double, 3> low{};
  std::array<double, 3> high{};

  double size(int axis) const { return high[axis] - low[axis]; }
  double volume() const { return size(0) * size(1) * size(2); }
};

/// The occupancies, in [0, 1], of the cells of a box. What is outside of the box is empty.
struct Octree {
  CellTree cells;
  Box bounds;
  int depth = 0;  // 2^depth cells along each axis are the finest that there may be

  /// The side of a cell of this depth.
  double cell_size(int axis, int at_depth) const;
};

/// A copy whose finest cells are of this depth: means of what was finer.
Octree coarsened(const Octree& octree, int depth);

/// An octree with these blocks, with `first` and all means set. Throws Error where they are no
/// tree: a level has not a block for each octant that is split, a value is not in [0, 1], there are
/// more levels than `depth`, or `depth` or `bounds` are out of range.
Octree make_octree(std::vector<TreeLevel> levels, float root, const Box& bounds, int depth);

/// Throws Error, with the name of the argument, where a box has no volume or is not finite.
void check_box(const Box& box, const char* argument);

/// Throws Error, with the name of the argument, for a depth out of [low, kMaxTreeDepth].
void check_depth(int depth, int low, const char* argument);

}  // namespace prefilter
