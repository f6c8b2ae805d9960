// SPDX-License-Identifier: GPL-3.0-or-later

// Curves under the box filter.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "prefilter/geometry/moments/arc_moments.h"
#include "prefilter/geometry/moments/monotone_polynomials.h"
#include "prefilter/shapes/raster/difference_rows.h"

namespace prefilter {

/// Adds up pieces of curves. Ends are rounded to multiples of kBoxUnit, as those of lines are.
class BoxCurves {
 public:
  explicit BoxCurves(DifferenceRows* rows) : rows_(*rows) {}

  /// A segment of any kind by its control points, as Outline has it.
  void add(std::span<const Point2> controls, double weight);

 private:
  /// Where a piece is, and its area from the start up to there.
  struct Places {
    std::vector<double> x;
    std::vector<double> y;
    std::vector<double> area;
    std::vector<std::int32_t> column;  // where one may add differences

    int count = 0;

    void make_room(int places) {
      if (static_cast<std::size_t>(places) <= x.size()) return;
      x.resize(places);
      y.resize(places);
      area.resize(places);
      column.resize(places);
    }
  };
  template <bool kIsCubic>
  class Values;

  /// The region on the right of a piece counts `sign` times.
  void add(const MonotoneCurve& piece, int sign);
  template <bool kIsCubic>
  void find_rows(const MonotonePolynomials& piece, double low, double high, bool rises);
  template <bool kIsCubic>
  void find_columns(const MonotonePolynomials& piece, int first, int end);
  void add_cells(const MonotoneCurve& piece, int sign);

  DifferenceRows& rows_;
  ArcBatch<0> batch_;
  ArcBatch<0>::Cells cell_;
  Places at_rows_;     // at the ends of a piece and at the lines between rows in between
  Places at_columns_;  // at the lines between columns
};

}  // namespace prefilter
