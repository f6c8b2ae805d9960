// From the moments in cells to the coverage of pixels: section 2.2.1, with all pieces of the filter
// at once.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "prefilter/base/lane_array.h"
#include "prefilter/raster/cell_filter.h"
#include "prefilter/raster/coverage_rows.h"
#include "prefilter/raster/moment_cells.h"

namespace prefilter {

/// Weighs cells by a filter, whose degree is N.
template <int N>
class MomentRows {
 public:
  /// For images of a width. The filter must outlive this.
  MomentRows(const CellFilter& filter, int width);

  /// Adds the coverage of the pixel rows [first_row, end_row), of which the first is row 0 of
  /// `rows`.
  void add_coverage(const MomentCells<N>& cells, int first_row, int end_row, CoverageRows* rows);

 private:
  static constexpr int kLanes = N < 4 ? 4 : 8;
  using Doubles = LaneArray<double, kLanes>;
  using Longs = LaneArray<std::int64_t, kLanes>;

  void start_row(int row, const Longs& across, CoverageRows* rows);
  void add_span(const MomentCells<N>& cells, int row, std::span<const int> columns, Longs* across,
                CoverageRows* rows);
  std::int64_t run_value(int tap, const Longs& across) const;
  // Of the cells before a column, how many are under a pixel.
  int taps_before(int pixel, int column) const;

  const CellFilter& filter_;
  int width_;
  int first_row_ = 0;
  int end_row_ = 0;
  std::vector<int> columns_;
  std::vector<Doubles> sums_;             // separable: of the pixels of a span, by P_b
  std::vector<double> values_;            // else: by tap along y
  std::vector<Doubles> along_y_;          // separable: of each tap, by P_b
  std::vector<double> integrals_before_;  // separable: of so many taps
  std::vector<Doubles> table_;            // else: of taps (oy, ox) and power a, by P_b
  std::vector<Doubles> table_before_;     // else: of tap oy and so many taps ox, by P_b
  std::vector<Longs> run_weights_;        // of each tap along y, by P_b, for cells that are alike
};

extern template class MomentRows<0>;
extern template class MomentRows<1>;
extern template class MomentRows<2>;
extern template class MomentRows<3>;
extern template class MomentRows<7>;

}  // namespace prefilter
