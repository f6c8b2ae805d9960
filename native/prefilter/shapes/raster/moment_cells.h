// SPDX-License-Identifier: GPL-3.0-or-later

// The cells of a band of rows that arcs touch, and the moments of what those leave in them.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "prefilter/geometry/moments/arc_moments.h"
#include "prefilter/shapes/raster/cell_filter.h"

namespace prefilter {

/// Cells are made where an arc comes; a grid of their places finds them again. N is the degree of
/// the moments along each axis.
template <int N>
class MomentCells {
 public:
  using Moments = ArcMoments<N>;

  /// The cells under the pixels of the rows [first_row, end_row) of images of a width.
  void begin_band(const CellFilter& filter, int width, int first_row, int end_row);
  const GridWindow& window() const { return window_; }
  /// Arcs have left something in rows of cells from the first of these up to the second alone.
  int first_used_row() const { return first_used_row_; }
  int end_used_row() const { return end_used_row_; }

  /// Adds a piece, in coordinates of cells; the region on its right counts `sign` times.
  void add(const MonotoneCurve& piece, int sign);

  /// Call this when all are added, before the cells are asked for.
  void finish() { batch_.flush(&cells_); }

  /// The columns of a row in which arcs leave something, rising.
  void columns_of(int row, std::vector<int>* columns) const;
  /// One of those.
  const Moments& at(int column, int row) const {
    return cells_[slots_[slot_place(column, row)] - 1];
  }

  /// What arcs left of the window are across a row, by P_b.
  std::array<std::int64_t, N + 1> left_of(int row) const;

  /// Forgets the cells, of which each row's columns were asked for.
  void clear();

 private:
  static constexpr int kBlock = 16;

  // Calls use(place in slots_) for the cells of a row, from left to right.
  template <typename Use>
  void for_slots(int row, const Use& use) const;
  std::size_t slot_place(int column, int row) const {
    return static_cast<std::size_t>(row - window_.first_row) * blocks_ * kBlock +
           (column - window_.first_column);
  }
  // The place in cells_ of a cell, made where there is none yet.
  std::int32_t cell(int column, int row);
  std::int32_t made(int row, std::int32_t* slot);
  void use_no_row() {
    first_used_row_ = window_.end_row;
    end_used_row_ = window_.first_row;
    first_used_block_ = blocks_;
    end_used_block_ = 0;
  }

  GridWindow window_;
  int first_used_row_ = 0;
  int end_used_row_ = 0;
  int blocks_ = 0;
  int first_used_block_ = 0;  // of a row
  int end_used_block_ = 0;
  std::vector<std::int32_t> slots_;     // one more than the place in cells_, or 0
  std::vector<std::uint16_t> touched_;  // of each block, the columns that have a cell, as bits
  std::vector<std::int32_t> left_;      // of each row, as slots_
  std::vector<Moments> cells_;
  ArcBatch<N> batch_;
};

extern template class MomentCells<0>;
extern template class MomentCells<1>;
extern template class MomentCells<2>;
extern template class MomentCells<3>;
extern template class MomentCells<4>;
extern template class MomentCells<5>;
extern template class MomentCells<7>;
extern template class MomentCells<8>;
extern template class MomentCells<9>;

}  // namespace prefilter
