// SPDX-License-Identifier: GPL-3.0-or-later

// Lines that cut a texture into cells on which the bilinear interpolants of levels are polynomials.
//
// The interpolant of a level is bilinear between the centers of its texels. The cells of level l
// here are cut along the centers of level l and of all coarser levels, so that on each of them all
// these interpolants are one bilinear polynomial, and a cell of level l + 1 is a block of whole
// cells of level l. For sides that are powers of two these are the half-texel grids of figure 7.4;
// for others, whose levels do not nest, they are the union of the levels' grids, and still about
// two cells to a texel along each axis.
#pragma once

#include <vector>

#include "prefilter/geometry/moments/cell_moments.h"

namespace prefilter {

/// A cell among the texel centers of a level, along one axis: it lies between the centers of texels
/// `texel` and `texel` + 1 (-1 and the size stand for those beyond the edges), and the coordinate x
/// in the cell is at placement.offset + placement.scale * x of the way.
struct CellPlace {
  int texel = 0;
  Placement placement;
};

/// The cell of the next level that a cell is a part of.
struct CellParent {
  int cell = 0;
  Placement placement;
};

/// The cells of all levels along one axis.
class AxisCells {
 public:
  /// `tile_size` texels of the image make a tile; tile edges are lines of the levels up to
  /// `last_tile_level`.
  AxisCells(int size, int level_count, int tile_size, int last_tile_level);

  int cell_count(int level) const { return static_cast<int>(lines_[level].size()) - 1; }
  /// Where the cells of a level end, in texels of the image; the first line is 0.
  const std::vector<double>& lines(int level) const { return lines_[level]; }
  /// The first cell of a level at or above a line.
  int cell_at(int level, double line) const;
  /// Each cell of `level` among the texels of level `of`, which is `level` itself or the next.
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

/// Cells along one axis that are cut along the edges of the texels of a level and of all coarser
/// ones: means over texels of every level are sums over whole cells.
class AxisTexels {
 public:
  AxisTexels(int size, int level_count);

  int cell_count(int level) const { return static_cast<int>(lines_[level].size()) - 1; }
  const std::vector<double>& lines(int level) const { return lines_[level]; }
  /// The texel of the level that each of its cells lies in.
  const std::vector<int>& texels(int level) const { return texels_[level]; }
  /// The cell of the next level that each cell lies in.
  const std::vector<int>& parents(int level) const { return parents_[level]; }

 private:
  std::vector<std::vector<double>> lines_;
  std::vector<std::vector<int>> texels_;
  std::vector<std::vector<int>> parents_;
};

}  // namespace prefilter
