// SPDX-License-Identifier: GPL-3.0-or-later

// From values over cells to those of pixels.
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

/// Weighs cells by a filter, for all pixels that have a share in them.
class CellPixels {
 public:
  /// For images of a width. The filter must outlive this.
  CellPixels(const CellFilter& filter, int width);

  /// What is added from here on goes to `values`, those of the pixel rows [first_row, end_row).
  void begin(int first_row, int end_row, BandValues* values);
  /// The integrals over a cell of a channel's value times x^a y^b, at [a * (degree + 1) + b].
  void add(int column, int row, int channel, std::span<const double> moments);
  /// A cell of which a share has the same color all over.
  void add_full(int column, int row, double share, std::span<const LinearPowers> color);
  /// The same of a filter of one cell a pixel: calls use(begin, end, values) for the cells that
  /// are in the image, with the values of the first one on.
  template <typename Use>
  void add_row(int begin, int end, int row, const Use& use) const;
  /// Cells [begin, end) that are one color.
  void add_constant(int begin, int end, int row, std::span<const double> color);

 private:
  template <typename Use>
  void for_pixels_over(int column, int row, const Use& use) const;

  const CellFilter& filter_;
  int width_;
  bool is_box_;  // which weighs a cell by 1 in its own pixel
  int first_row_ = 0;
  int end_row_ = 0;
  BandValues* values_ = nullptr;
  std::vector<LinearPowers> full_;  // of taps (oy, ox): the integrals of the color's powers
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
