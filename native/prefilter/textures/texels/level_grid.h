// SPDX-License-Identifier: GPL-3.0-or-later

// Grid lines that divide a texture into cells on which the bilinear interpolants of all levels are
// polynomials.
//
// The interpolant of a level is bilinear between the centers of its texels. The lines of level l
// are the texel centers of level l and of all coarser levels. So on each cell all these
// interpolants are bilinear polynomials, and a cell of level l + 1 is a block of whole cells of
// level l. For sides that are powers of two these are the half-texel grids of figure 7.4. Levels
// with other sizes do not nest; their grids are unions, still with about two cells per texel along
// each axis.
// two cells to a texel along each axis.
#pragma once

#include <vector>

#include "prefilter/geometry/moments/cell_moments.h"

namespace prefilter {

/// Position of a cell between the texel centers of a level, along one axis. It lies between the
/// centers of texels `texel` and `texel` + 1; -1 and the size stand for the texels beyond the
/// edges. The coordinate x in the cell corresponds to the fraction placement.offset +
/// placement.scale * x of the way between the two centers.
struct CellPlace {
  int texel = 0;
  Placement placement;
};

/// The cell of the next level that contains a cell.
struct CellParent {
  int cell = 0;
  Placement placement;
};

/// The cells of all levels along one axis.
class AxisCells {
 public:
  /// Tiles are `tile_size` texels of the image wide; their edges are lines of all levels up to
  /// `last_tile_level`.
  AxisCells(int size, int level_count, int tile_size, int last_tile_level);

  int cell_count(int level) const { return static_cast<int>(lines_[level].size()) - 1; }
  /// Lines between the cells of a level, in texels of the image; the first one is 0.
  const std::vector<double>& lines(int level) const { return lines_[level]; }
  /// The first cell of a level at or above a line.
  int cell_at(int level, double line) const;
  /// Positions of the cells of `level` between texel centers of level `of`: `level` or the next.
  const std::vector<CellPlace>& places(int level, int of) const;
  const std::vector<CellParent>& parents(int level) const { return parents_[level]; }
  /// Whether the cells of level 1 are the texels of the image.
  bool halves_evenly() const { return halves_evenly_; }

 private:
  std::vector<std::vector<double>> lines_;
  std::vector<std::vector<CellPlace>> places_;
  std::vector<std::vector<CellPlace>> next_places_;
  std::vector<std::vector<CellParent>> parents_;
  bool halves_evenly_ = false;
};

/// Cells along one axis, divided along the texel edges of a level and of all coarser levels, so
/// that means over texels of any level are sums over whole cells.
class AxisTexels {
 public:
  AxisTexels(int size, int level_count);

  int cell_count(int level) const { return static_cast<int>(lines_[level].size()) - 1; }
  const std::vector<double>& lines(int level) const { return lines_[level]; }
  /// The texel that contains each cell of the level.
  const std::vector<int>& texels(int level) const { return texels_[level]; }
  /// The cell of the next level that contains each cell of the level.
  const std::vector<int>& parents(int level) const { return parents_[level]; }

 private:
  std::vector<std::vector<double>> lines_;
  std::vector<std::vector<int>> texels_;
  std::vector<std::vector<int>> parents_;
};

}  // namespace prefilter
