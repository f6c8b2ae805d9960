// SPDX-License-Identifier: GPL-3.0-or-later

// The surface within a leaf of an occupancy octree, as the leaf and its neighbors fix it.
//
// Beyond the text, whose cells hold no more than a value. Sums of columns of occupancies are mean
// heights of the surface (Cummins et al. 2005); those of three by three columns give a quadratic.
// Where columns do not run from full to empty the gradient of the 27 cells gives a plane (Youngs
// 1982). Either is moved so that the leaf keeps its occupancy.
#pragma once

#include <array>
#include <optional>

#include "prefilter/base/geometry.h"
#include "prefilter/wavelet/cell_tree.h"

namespace prefilter {

/// The coordinates of a cell, in cells of its depth.
using LeafPlace = std::array<int, 3>;

/// Of an octant of a cell, in cells of the octant's depth.
inline LeafPlace octant_place(const LeafPlace& at, int o) {
  return {2 * at[0] + (o & 1), 2 * at[1] + ((o >> 1) & 1), 2 * at[2] + ((o >> 2) & 1)};
}

/// Whether a cell is neither full nor empty.
inline bool is_fraction(float occupancy) { return occupancy > 0.0F && occupancy < 1.0F; }

/// What is below a quadratic over one of the sides of a leaf.
class LeafSurface {
 public:
  /// The surface within a leaf of `tree` at a place of a depth, of an occupancy in (0, 1). None
  /// where the neighbors tell no side from the other: in sheets thinner than the leaf, in noise.
  ///
  /// `parts` by `parts` by `parts` boxes of the leaf hold its occupancy together.
  static std::optional<LeafSurface> find(const CellTree& tree, int depth, const LeafPlace& at,
                                         int parts);

  /// The share that is inside of a box, in coordinates in which the leaf is the unit cube: exact
  /// for planes, and as if the surface were flat over the box otherwise. In [0, 1].
  double share(const Box& box) const;

  /// 0 or 1 where no part of the surface, curved as it is, is within the box; otherwise none.
  std::optional<float> uniform_value(const Box& box) const;

 private:
  // Of the surface over a rectangle of the plane across the axis: its mean height, and how much it
  // rises from side to side.
  struct Patch {
    double height;
    double first_rise;
    double second_rise;
  };
  Patch patch(double first_low, double first_high, double second_low, double second_high) const;
  Patch patch(const Box& box) const;
  // The box along the axis.
  std::array<double, 2> extent(const Box& box) const;
  bool has_heights(const CellTree& tree, int depth, const LeafPlace& at);
  void fit_height(double occupancy, int parts);

  // Heights count from the leaf's center along the axis, toward the outside.
  int axis_ = 0;
  bool is_up_ = true;
  double height_ = 0.0;  // the mean over the leaf
  std::array<float, 2> slopes_{};
  std::array<float, 2> curvatures_{};
  float twist_ = 0.0F;
};

/// The occupancy of a cell of a tree, or of the leaf that holds it; 0 outside of the root.
float occupancy_at(const CellTree& tree, int depth, const LeafPlace& at);

}  // namespace prefilter
