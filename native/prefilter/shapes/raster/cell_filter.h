// SPDX-License-Identifier: GPL-3.0-or-later

// A filter as polynomials on the cells of a grid.
#pragma once

#include <string_view>
#include <vector>

#include "prefilter/images/kernel.h"

namespace prefilter {

/// The filter of pixel i along an axis covers the cells first_cell(i) to first_cell(i) + taps - 1.
/// On each it is a polynomial in the coordinate relative to the cell's center, in [-1/2, 1/2].
struct CellFilter {
  int cells_per_pixel = 1;
  /// Cell coordinate = pixel coordinate * cells_per_pixel + shift.
  double shift = 0.0;
  int first = 0;
  int taps = 1;
  int degree = 0;  // 0 to 3, or Kernel::kMostDegree, for which rasterize is instantiated
  bool is_separable = true;
  /// If separable: the coefficient of power a of tap o is at [o * (degree + 1) + a].
  std::vector<double> along;
  /// Otherwise: the coefficient of x^a y^b of tap (ox, oy) is at [((oy * taps + ox) * (degree + 1)
  /// + b) * (degree + 1) + a].
  std::vector<double> table;

  int first_cell(int pixel) const { return cells_per_pixel * pixel + first; }
  /// The first and the last pixel whose filter covers a cell.
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

/// The filter with this name, or null.
const CellFilter* find_cell_filter(std::string_view name);

}  // namespace prefilter
