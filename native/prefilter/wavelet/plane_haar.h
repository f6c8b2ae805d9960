// SPDX-License-Identifier: GPL-3.0-or-later

// The Haar basis on a quadtree (sections 3.2 and 3.2.2), and the coefficients of outlines.
//
// As on the octree (haar.h), the factor 2^j is omitted: the coefficient of a cell is the mean of
// the function times the wavelet over it.
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

/// The coefficients of the winding number of outlines. A gap of length L changes the mean of a cell
/// by at most 1.07 L / s for each of the cells of side s that contain both, and the mean of the
/// root, of side S, by at most L / S.
class PlaneHaar {
 public:
  PlaneHaar() = default;
  /// Takes the results of all strips of a grid.
  PlaneHaar(const PlaneGrid& grid, std::span<StripBricks> strips);

  /// Synthesis (equation 3.3) down to cells of side 2^cell_depth, for rows [first_row, end_row),
  /// which are multiples of a brick's side unless the grid ends there. Calls use_run(row, begin,
  /// end, value) for cells of a row with the same value, and block(x, y, values) for bricks, with 8
  /// values per row; x and y are multiples of 8, and the block may extend beyond the grid's columns
  /// and the rows. Each cell is in exactly one of these.
  ///
  /// For closed outlines values away from the curves are integers; rounding errors up to 1e-5 are
  /// removed.
  template <typename UseRun, typename Block>
  void synthesise(int cell_depth, int first_row, int end_row, const UseRun& use_run,
                  const Block& block) const;

  double mean() const { return mean_; }

 private:
  using BrickValues = std::array<float, kPlaneBrickSide * kPlaneBrickSide>;

  struct Node {
    int x = 0;
    int y = 0;
    QuadrantFluxes fluxes{};
    // For each quadrant, its index on the next level or in bricks_; -1 without curves.
    std::array<std::int32_t, 4> next{-1, -1, -1, -1};
  };

  static float without_rounding(double value) {
    const double whole = std::rint(value);
    return static_cast<float>(std::abs(value - whole) <= 1e-5 ? whole : value);
  }
  static void brick_values(const PlaneBrick& brick, float mean, int cell_depth,
                           BrickValues* values);

  template <typename UseRun, typename Block>
  struct Walk {
    const PlaneHaar& tree;
    int cell_depth;
    int first_row;
    int end_row;
    const UseRun& use_run;
    const Block& block;

    void visit(int level, int x, int y, int place, double mean) const;
    void fill(int level, int x, int y, double mean) const;
  };

  PlaneGrid grid_;
  double mean_ = 0.0;  // over the root
  // levels_[k]: cells of depth k; the children of the last level are bricks.
  std::vector<std::vector<Node>> levels_;
  std::vector<PlaneBrick> bricks_;
};

template <typename UseRun, typename Block>
void PlaneHaar::Walk<UseRun, Block>::fill(int level, int x, int y, double mean) const {
  const int side = 1 << (tree.grid_.depth - level);
  const int begin = x * side;
  const int end = std::min(begin + side, tree.grid_.width);
  if (begin >= end) return;
  const float value = without_rounding(mean);
  for (int row = std::max(y * side, first_row); row < std::min(y * side + side, end_row); ++row) {
    use_run(row, begin, end, value);
  }
}

// Visits a cell of a level within the requested rows.
template <typename UseRun, typename Block>
void PlaneHaar::Walk<UseRun, Block>::visit(int level, int x, int y, int place, double mean) const {
  const int depth = tree.grid_.depth - level;
  if (place < 0) {
    fill(level, x, y, mean);
    return;
  }
  if (depth <= cell_depth) {
    const int side = 1 << depth;
    const int end = std::min(x * side + side, tree.grid_.width);
    for (int row = std::max(y * side, first_row); row < std::min(y * side + side, end_row); ++row) {
      use_run(row, x * side, end, static_cast<float>(mean));
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

template <typename UseRun, typename Block>
void PlaneHaar::synthesise(int cell_depth, int first_row, int end_row, const UseRun& use_run,
                           const Block& block) const {
  const Walk<UseRun, Block> walk{*this, cell_depth, first_row, end_row, use_run, block};
  walk.visit(0, 0, 0, bricks_.empty() ? -1 : 0, mean_);
}

}  // namespace prefilter
