// SPDX-License-Identifier: GPL-3.0-or-later

// The Haar basis on a quadtree (sections 3.2 and 3.2.2), and what outlines have in it.
//
// As on the octree (haar.h), without the factor 2^j: the coefficient of a cell is the mean of the
// function times the wavelet over it.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "prefilter/wavelet/outline_strip.h"

namespace prefilter {

/// The coefficients of the winding number of outlines, where these pass. A gap of length L in them
/// changes the mean of a cell by at most 1.07 L / s for each of the cells of side s that hold both,
/// and that of the root, of side S, by at most L / S.
class PlaneHaar {
 public:
  PlaneHaar() = default;
  /// Of all strips of a grid; they are taken.
  PlaneHaar(const PlaneGrid& grid, std::span<StripBricks> strips);

  /// Synthesis (equation 3.3) down to cells of side 2^cell_depth, of the rows [first_row, end_row):
  /// multiples of a brick's side, unless the grid ends there. Calls run(row, begin, end, value) for
  /// cells of a row of one value, and block(x, y, values) for bricks, with 8 values a row; x, y
  /// are multiples of 8, and what is not within the grid's columns and the rows is to be left out.
  /// Each cell is in just one of these.
  ///
  /// Where no curve passes values are whole for closed outlines; rounding within 1e-5 is taken
  /// back.
  template <typename Run, typename Block>
  void synthesise(int cell_depth, int first_row, int end_row, const Run& run,
                  const Block& block) const;

  double mean() const { return mean_; }

 private:
  using BrickValues = std::array<float, kPlaneBrickSide * kPlaneBrickSide>;

  struct Node {
    int x = 0;
    int y = 0;
    QuadrantFluxes fluxes{};
    // Of each quadrant, the place on the next level, or in bricks_; -1 where no curve passes.
    std::array<std::int32_t, 4> next{-1, -1, -1, -1};
  };

  static float without_rounding(double value) {
    const double whole = std::rint(value);
    return static_cast<float>(std::abs(value - whole) <= 1e-5 ? whole : value);
  }
  static void brick_values(const PlaneBrick& brick, float mean, int cell_depth,
                           BrickValues* values);

  template <typename Run, typename Block>
  struct Walk {
    const PlaneHaar& tree;
    int cell_depth;
    int first_row;
    int end_row;
    const Run& run;
    const Block& block;

    void visit(int level, int x, int y, int place, double mean) const;
    void fill(int level, int x, int y, double mean) const;
  };

  PlaneGrid grid_;
  double mean_ = 0.0;  // over the root
  // levels_[k]: of 2^k along an axis; the children of the last are bricks.
  std::vector<std::vector<Node>> levels_;
  std::vector<PlaneBrick> bricks_;
};

template <typename Run, typename Block>
void PlaneHaar::Walk<Run, Block>::fill(int level, int x, int y, double mean) const {
  const int side = 1 << (tree.grid_.depth - level);
  const int begin = x * side;
  const int end = std::min(begin + side, tree.grid_.width);
  if (begin >= end) return;
  const float value = without_rounding(mean);
  for (int row = std::max(y * side, first_row); row < std::min(y * side + side, end_row); ++row) {
    run(row, begin, end, value);
  }
}

// A cell of a level, within the rows that are wanted.
template <typename Run, typename Block>
void PlaneHaar::Walk<Run, Block>::visit(int level, int x, int y, int place, double mean) const {
  const int depth = tree.grid_.depth - level;
  if (place < 0) {
    fill(level, x, y, mean);
    return;
  }
  if (depth <= cell_depth) {
    const int side = 1 << depth;
    const int end = std::min(x * side + side, tree.grid_.width);
    for (int row = std::max(y * side, first_row); row < std::min(y * side + side, end_row); ++row) {
      run(row, x * side, end, static_cast<float>(mean));
    }
    return;
  }
  if (depth == kPlaneBrickDepth) {
    BrickValues values;
    brick_values(tree.bricks_[place], static_cast<float>(mean), cell_depth, &values);
    block(x * kPlaneBrickSide, y * kPlaneBrickSide, values);
    return;
  }
  const Node& node = tree.levels_[level][place];
  const auto values = steps_of_quadrants<double>(node.fluxes).values(mean);
  const int half = 1 << (depth - 1);
  for (int q = 0; q < 4; ++q) {
    const int child_x = 2 * x + (q & 1);
    const int child_y = 2 * y + (q >> 1);
    if (child_x * half >= tree.grid_.width) continue;
    if (child_y * half >= end_row || (child_y + 1) * half <= first_row) continue;
    visit(level + 1, child_x, child_y, node.next[q], values[q]);
  }
}

template <typename Run, typename Block>
void PlaneHaar::synthesise(int cell_depth, int first_row, int end_row, const Run& run,
                           const Block& block) const {
  const Walk<Run, Block> walk{*this, cell_depth, first_row, end_row, run, block};
  walk.visit(0, 0, 0, bricks_.empty() ? -1 : 0, mean_);
}

}  // namespace prefilter
