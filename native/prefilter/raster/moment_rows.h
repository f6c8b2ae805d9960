// From the arcs in the cells of a band of rows to its pixels: section 2.2.1, with all pieces of
// the filter at once.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "prefilter/moments/arc_moments.h"
#include "prefilter/raster/cell_filter.h"
#include "prefilter/raster/coverage_rows.h"

namespace prefilter {

/// The cells that arcs touch, under the pixels of a band of rows. N is the degree of the moments
/// along each axis, the filter's or above.
template <int N>
class MomentRows {
 public:
  using Moments = ArcMoments<N>;

  /// For images of a width. The filter must outlive this.
  MomentRows(const CellFilter& filter, int width);

  /// For the rows [first_row, end_row) of pixels.
  void begin_band(int first_row, int end_row);

  /// Adds a piece, in coordinates of cells; the region on its right counts `sign` times.
  void add(const MonotoneCurve& piece, int sign);

  /// Adds to rows, of which row 0 is the band's first, the coverage by what was added, and forgets
  /// that.
  void flush(CoverageRows* rows);

 private:
  static constexpr int kLanes = Moments::kLanes;
  static constexpr int kBlock = 16;
  using Doubles = LaneArray<double, kLanes>;
  using Longs = LaneArray<std::int64_t, kLanes>;

  Moments& cell(int column, int row);
  void take_columns(int row);
  void flush_row(int row, CoverageRows* rows);
  void flush_span(int row, std::span<const int> columns, Longs* across, CoverageRows* rows);
  std::int64_t run_value(int tap, const Longs& across) const;
  /// Of the cells before a column, how many are under a pixel.
  int taps_before(int pixel, int column) const;

  const CellFilter& filter_;
  int width_;
  int first_row_ = 0;
  int end_row_ = 0;
  GridWindow window_;
  int blocks_ = 0;
  std::vector<std::int32_t> slots_;  // one more than the place in cells_, or 0
  std::vector<std::uint8_t> is_touched_;
  std::vector<Moments> cells_;
  std::vector<int> columns_;
  std::vector<Doubles> sums_;             // separable: of the pixels of a span, by P_b
  std::vector<double> values_;            // of the pixels of a span, by tap along y
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
