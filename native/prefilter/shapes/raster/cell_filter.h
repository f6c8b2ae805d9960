// SPDX-License-Identifier: GPL-3.0-or-later

// A filter as polynomials on the cells of a grid, the way its moments are weighed.
#pragma once

#include <string_view>
#include <vector>

#include "prefilter/images/kernel.h"

namespace prefilter {

/// Pixel i along an axis is weighed over the cells first_cell(i) to first_cell(i) + taps - 1, each
/// by a polynomial in the coordinate from the cell's center, [-1/2, 1/2].
struct CellFilter {
  int cells_per_pixel = 1;
  /// A coordinate in pixels times cells_per_pixel plus this is one in cells.
  double shift = 0.0;
  int first = 0;
  int taps = 1;
  int degree = 0;  // 0 to 3, or Kernel::kMostDegree: what rasterize has code for
  bool is_separable = true;
  /// Separable: of tap o, the coefficient of power a at [o * (degree + 1) + a].
  std::vector<double> along;
  /// Else: of taps (ox, oy), that of x^a y^b at
  /// [((oy * taps + ox) * (degree + 1) + b) * (degree + 1) + a].
  std::vector<double> table;

  int first_cell(int pixel) const { return cells_per_pixel * pixel + first; }
  /// The pixels that weigh a cell: from the first to the last.
  int first_pixel_over(int cell) const { return floor_division(cell - first - taps) + 1; }
  int last_pixel_over(int cell) const { return floor_division(cell - first); }
  double to_cell(double coordinate) const { return coordinate * cells_per_pixel + shift; }
  double to_pixel(double cell) const { return (cell - shift) / cells_per_pixel; }

 private:
  int floor_division(int cells) const {
    return cells >= 0 ? cells / cells_per_pixel
                      : -((cells_per_pixel - 1 - cells) / cells_per_pixel);
  }
};

CellFilter cell_filter(const Kernel& kernel);

/// The filter of a name, or none.
const CellFilter* find_cell_filter(std::string_view name);

}  // namespace prefilter
