// SPDX-License-Identifier: GPL-3.0-or-later

// Distributes cell values to pixels.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "prefilter/shapes/raster/band_values.h"
#include "prefilter/shapes/raster/cell_filter.h"
#include "prefilter/shapes/raster/local_color.h"

namespace prefilter {

/// Weights cells by a filter for all pixels whose filter covers them.
class CellPixels {
 public:
  /// For images of a given width. The filter must outlive this object.
  CellPixels(const CellFilter& filter, int width);

  /// Directs further additions to `values`, the pixel rows [first_row, end_row).
  void begin(int first_row, int end_row, BandValues* values);
  /// Adds a cell by the integrals of a channel's value times x^a y^b, at [a * (degree + 1) + b].
  void add(int column, int row, int channel, std::span<const double> moments);
  /// Adds a cell of which the fraction `share` has this color everywhere.
  void add_full(int column, int row, double share, std::span<const LinearPowers> color);
  /// For filters with one cell per pixel: calls use(begin, end, values) for the cells inside the
  /// image, with the values from the first cell on.
  template <typename Use>
  void add_row(int begin, int end, int row, const Use& use) const;
  /// Adds cells [begin, end) of one constant color.
  void add_constant(int begin, int end, int row, std::span<const double> color);

 private:
  template <typename Use>
  void for_pixels_over(int column, int row, const Use& use) const;

  const CellFilter& filter_;
  int width_;
  bool is_box_;  // one cell per pixel, of weight 1
  int first_row_ = 0;
  int end_row_ = 0;
  BandValues* values_ = nullptr;
  // by tap (oy, ox): integrals of the filter times the powers of a linear color
  std::vector<LinearPowers> full_;
};

template <typename Use>
void CellPixels::add_row(int begin, int end, int row, const Use& use) const {
  const int y = filter_.first_pixel_over(row);
  const int shift = filter_.first_cell(0);
  begin = std::max(begin, shift);
  end = std::min(end, shift + width_);
  if (y < first_row_ || y >= end_row_ || begin >= end) return;
  use(begin, end, values_->pixels(y - first_row_, begin - shift, end - shift));
}

}  // namespace prefilter
