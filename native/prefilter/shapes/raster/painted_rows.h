// SPDX-License-Identifier: GPL-3.0-or-later

// The values of pixels under a shape whose color changes from place to place.
#pragma once

#include <vector>

#include "prefilter/shapes/raster/band_values.h"
#include "prefilter/shapes/raster/cell_filter.h"
#include "prefilter/shapes/raster/cell_pixels.h"
#include "prefilter/shapes/raster/local_color.h"
#include "prefilter/shapes/raster/moment_cells.h"

namespace prefilter {

/// Weighs cells by a filter times a color, which is a polynomial on each cell: exact for linear
/// colors. N is the filter's degree and the color's together.
template <int N>
class PaintedRows {
 public:
  /// For images of a width. The filter must outlive this.
  PaintedRows(const CellFilter& filter, int width);

  /// Adds to `values`, those of the pixel rows [first_row, end_row), the color of what lies in
  /// the cells.
  void add_values(const MomentCells<N>& cells, const LocalColor& color, int first_row, int end_row,
                  BandValues* values);

 private:
  using Moments = std::array<std::array<double, N + 1>, N + 1>;  // of x^a y^b, at [a][b]

  void add_cell(int column, int row, const Moments& moments, const LocalColor& color);
  void add_full_cells(int begin, int end, int row, double share, const LocalColor& color);

  const CellFilter& filter_;
  bool is_box_;  // which weighs a pixel's own cell alone, all over alike
  CellPixels pixels_;
  std::vector<int> columns_;
};

extern template class PaintedRows<1>;
extern template class PaintedRows<2>;
extern template class PaintedRows<3>;
extern template class PaintedRows<4>;
extern template class PaintedRows<8>;

}  // namespace prefilter
