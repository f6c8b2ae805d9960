// SPDX-License-Identifier: GPL-3.0-or-later

// What the outlines of a stack leave in the cells of a band.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "prefilter/moments/cell_cutter.h"
#include "prefilter/raster/cell_filter.h"
#include "prefilter/raster/layer_stack.h"

namespace prefilter {

/// Part of a monotone curve in a cell, from its lower end. Coordinates are from the cell's center.
struct StackArc {
  static constexpr std::uint32_t kLine = UINT32_MAX;

  Point2 low;
  Point2 high;
  std::uint32_t layer = 0;
  std::int32_t column = 0;
  std::int32_t winding = 1;     // what the number to its right is higher by than that to its left
  std::uint32_t curve = kLine;  // one of StackArcs::curves()
};

/// Where on a curve an arc is.
struct StackCurve {
  std::uint32_t piece = 0;
  double t_begin = 0.0;  // along the piece, which may fall
  double t_end = 1.0;
};

class StackArcs {
 public:
  /// What lies left of the window is in the column before its first.
  void gather(const LayerStack& stack, const CellFilter& filter, int width, int first_row,
              int end_row);
  const GridWindow& window() const { return window_; }
  /// The arcs of a row of cells by columns, and in each by layers from the highest. They are valid
  /// until the next call.
  std::span<const StackArc> in_row(int row);
  const StackCurve& curve(const StackArc& arc) const { return curves_[arc.curve]; }
  /// In coordinates of cells.
  const MonotoneCurve& piece(const StackCurve& curve) const { return pieces_[curve.piece]; }

 private:
  using Arcs = std::vector<StackArc>;

  void add(const MonotoneCurve& piece, int sign, std::uint32_t layer);
  Arcs::iterator merge_equal(Arcs::iterator begin, Arcs::iterator end) const;
  Arcs& row(int row) { return rows_[row - window_.first_row]; }

  GridWindow window_;
  std::vector<Arcs> rows_;
  std::vector<StackCurve> curves_;
  std::vector<MonotoneCurve> pieces_;
  Arcs sorted_;
  std::vector<std::uint32_t> first_;  // of each column
};

}  // namespace prefilter
