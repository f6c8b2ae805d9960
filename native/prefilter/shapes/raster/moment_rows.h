// SPDX-License-Identifier: GPL-3.0-or-later

// Converts the moments of cells to the coverage of pixels: section 2.2.1, for all pieces of the
// filter at once.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "prefilter/base/vectors.h"
#include "prefilter/shapes/raster/cell_filter.h"
#include "prefilter/shapes/raster/coverage_rows.h"
#include "prefilter/shapes/raster/moment_cells.h"

namespace prefilter {

/// Weights cells by a filter of degree N.
template <int N>
class MomentRows {
 public:
  /// For images of a given width. The filter must outlive this object.
  MomentRows(const CellFilter& filter, int width);

  /// Adds the coverage of the pixel rows [first_row, end_row); `first_row` is row 0 of `rows`.
  void add_coverage(const MomentCells<N>& cells, int first_row, int end_row, CoverageRows* rows);

 private:
  // Moments by P_b, in pairs; the last pair may have one above N, of weight 0.
  static constexpr int kCount = N + 1;
  static constexpr int kPairs = (kCount + 1) / 2;
  static constexpr int kMaxTaps = 8;
  using Pair = Vector<double, 2>;
  struct Powers {
    Pair v[kPairs] = {};
  };
  struct ByTap {
    Pair v[kMaxTaps / 2] = {};
  };
  using Across = std::array<std::int64_t, kCount>;

  void start_row(int row, const Across& across, CoverageRows* rows);
  void add_span(const MomentCells<N>& cells, int row, std::span<const int> columns, Across* across,
                CoverageRows* rows);
  void add_equal_cells(int from, int to, const Across& across);
  void add_cell(int column, const ArcMoments<N>& cell, const Across& across);
  std::int64_t run_value(int tap, const Across& across) const;
  // How many of the cells below a pixel are before a column.
  int taps_before(int pixel, int column) const;

  const CellFilter& filter_;
  int width_;
  int first_row_ = 0;
  int end_row_ = 0;
  int first_pixel_ = 0;  // of the current span
  int end_pixel_ = 0;
  std::vector<int> columns_;
  std::vector<Powers> sums_;              // separable: pixels of the span, by P_b
  std::vector<ByTap> values_;             // pixels of the span, by tap along y
  std::array<ByTap, kCount> along_y_{};   // separable: for P_b, by tap
  std::vector<double> integrals_before_;  // separable: integrals of the first taps
  std::vector<Powers> table_;             // not separable: for tap (oy, ox) and power a, by P_b
  // not separable: for tap oy, sums over the first taps ox, by P_b
  std::vector<Powers> table_before_;
  std::vector<Across> run_weights_;  // for each tap along y, by P_b, of full rows
};

extern template class MomentRows<0>;
extern template class MomentRows<1>;
extern template class MomentRows<2>;
extern template class MomentRows<3>;
extern template class MomentRows<7>;

}  // namespace prefilter
