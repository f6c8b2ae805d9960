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

/// Accumulates pieces of curves. Their ends are rounded to multiples of kBoxUnit, as the ends of
/// lines are.
class BoxCurves {
 public:
  explicit BoxCurves(DifferenceRows* rows) : rows_(*rows) {}

  /// Adds a segment of any kind, with control points and weight as in Outline.
  void add(std::span<const Point2> controls, double weight);

 private:
  /// Points of a piece, and the area from its start to each.
  struct CurvePoints {
    std::vector<double> x;
    std::vector<double> y;
    std::vector<double> area;
    std::vector<std::int32_t> column;  // clamped to the columns of the differences

    int count = 0;

    void make_room(int points) {
      if (static_cast<std::size_t>(points) <= x.size()) return;
      x.resize(points);
      y.resize(points);
      area.resize(points);
      column.resize(points);
    }
  };
  template <bool kIsCubic>
  class Values;

  /// The region to the right of a piece counts `sign` times.
  void add(const MonotoneCurve& piece, int sign);
  template <bool kIsCubic>
  void find_rows(const MonotonePolynomials& piece, double low, double high, bool rises);
  template <bool kIsCubic>
  void find_columns(const MonotonePolynomials& piece, int first, int end);
  void add_cells(const MonotoneCurve& piece, int sign);

  DifferenceRows& rows_;
  ArcBatch<0> batch_;
  ArcBatch<0>::Cells cell_;
  CurvePoints at_rows_;     // at the ends of a piece and at the lines between rows
  CurvePoints at_columns_;  // at the lines between columns
};

}  // namespace prefilter
