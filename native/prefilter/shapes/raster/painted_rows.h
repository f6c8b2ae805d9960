// SPDX-License-Identifier: GPL-3.0-or-later

// Pixel values of a shape whose color varies linearly.
#pragma once

#include <vector>

#include "prefilter/shapes/raster/band_values.h"
#include "prefilter/shapes/raster/cell_filter.h"
#include "prefilter/shapes/raster/cell_pixels.h"
#include "prefilter/shapes/raster/local_color.h"
#include "prefilter/shapes/raster/moment_cells.h"

namespace prefilter {

/// Weights cells by the product of a filter and a color, a polynomial on each cell, so that linear
/// colors are exact. N is the sum of both degrees.
template <int N>
class PaintedRows {
 public:
  /// For images of a given width. The filter must outlive this object.
  PaintedRows(const CellFilter& filter, int width);

  /// Adds the color of the region in the cells to `values`, the pixel rows [first_row, end_row).
  void add_values(const MomentCells<N>& cells, const LocalColor& color, int first_row, int end_row,
                  BandValues* values);

 private:
  using Moments = std::array<std::array<double, N + 1>, N + 1>;  // of x^a y^b, at [a][b]

  void add_cell(int column, int row, const Moments& moments, const LocalColor& color);
  void add_full_cells(int begin, int end, int row, double share, const LocalColor& color);

  const CellFilter& filter_;
  bool is_box_;  // each pixel covers one cell with constant weight
  CellPixels pixels_;
  std::vector<int> columns_;
};

extern template class PaintedRows<1>;
extern template class PaintedRows<2>;
extern template class PaintedRows<3>;
extern template class PaintedRows<4>;
extern template class PaintedRows<8>;

}  // namespace prefilter
