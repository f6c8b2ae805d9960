// SPDX-License-Identifier: GPL-3.0-or-later

// Reconstructs the surface within a leaf of an occupancy octree from the leaf and its neighbors.
//
// This goes beyond the dissertation, whose cells only have a value. Sums of columns of occupancies
// are mean heights of the surface (Cummins et al. 2005); the sums of 3 x 3 columns define a
// quadratic. If columns do not go from full to empty, the gradient of the 27 cells defines a plane
// (Youngs 1982). Either is shifted to preserve the leaf's occupancy.
#pragma once

#include <array>
#include <optional>

#include "prefilter/base/geometry.h"
#include "prefilter/wavelet/cell_tree.h"

namespace prefilter {

/// Coordinates of a cell, in cells of its depth.
using LeafPlace = std::array<int, 3>;

/// Coordinates of an octant of a cell, in cells of the octant's depth.
inline LeafPlace octant_place(const LeafPlace& at, int o) {
  return {2 * at[0] + (o & 1), 2 * at[1] + ((o >> 1) & 1), 2 * at[2] + ((o >> 2) & 1)};
}

/// Whether a cell is neither full nor empty.
inline bool is_fraction(float occupancy) { return occupancy > 0.0F && occupancy < 1.0F; }

/// The region below a quadratic height field over one side of a leaf.
class LeafSurface {
 public:
  /// The surface within a leaf of `tree` with an occupancy in (0, 1). Nothing if the neighbors do
  /// not determine its orientation, as in sheets thinner than the leaf and in noise.
  ///
  /// The mean over `parts` x `parts` x `parts` boxes of the leaf equals its occupancy.
  static std::optional<LeafSurface> find(const CellTree& tree, int depth, const LeafPlace& at,
                                         int parts);

  /// The occupied fraction, in [0, 1], of a box in coordinates of the leaf's unit cube. Exact for
  /// planes; otherwise the surface is approximated by a plane over the box.
  double share(const Box& box) const;

  /// 0 or 1 if the curved surface does not intersect the box; otherwise nothing.
  std::optional<float> uniform_value(const Box& box) const;

 private:
  // The surface over a rectangle across the axis: its mean height, and its rises from side to side.
  struct Patch {
    double height;
    double first_rise;
    double second_rise;
  };
  Patch patch(double first_low, double first_high, double second_low, double second_high) const;
  Patch patch(const Box& box) const;
  // The range of a box along the axis.
  std::array<double, 2> extent(const Box& box) const;
  bool has_heights(const CellTree& tree, int depth, const LeafPlace& at);
  void fit_height(double occupancy, int parts);

  // Heights are along the axis, from the leaf's center toward the outside.
  int axis_ = 0;
  bool is_up_ = true;
  double height_ = 0.0;  // mean over the leaf
  std::array<float, 2> slopes_{};
  std::array<float, 2> curvatures_{};
  float twist_ = 0.0F;
};

/// The occupancy of a cell of a tree, or of the leaf that contains it; 0 outside the root.
float occupancy_at(const CellTree& tree, int depth, const LeafPlace& at);

}  // namespace prefilter
