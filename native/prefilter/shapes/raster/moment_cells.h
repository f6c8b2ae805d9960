// SPDX-License-Identifier: GPL-3.0-or-later

// Moments of the region beside arcs, in the cells of a band that arcs touch.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "prefilter/geometry/moments/arc_moments.h"
#include "prefilter/shapes/raster/cell_filter.h"

namespace prefilter {

/// Cells are allocated when an arc enters them, and found by a grid of indices. N is the degree of
/// the moments along each axis.
template <int N>
class MomentCells {
 public:
  using Moments = ArcMoments<N>;

  /// Starts the cells below the pixel rows [first_row, end_row) of images of a given width.
  void begin_band(const CellFilter& filter, int width, int first_row, int end_row);
  const GridWindow& window() const { return window_; }
  /// Range of cell rows with contributions.
  int first_used_row() const { return first_used_row_; }
  int end_used_row() const { return end_used_row_; }

  /// Adds a piece in cell coordinates; the region on its right counts `sign` times.
  void add(const MonotoneCurve& piece, int sign);

  /// Must be called after the last piece, before cells are read.
  void finish() { batch_.flush(&cells_); }

  /// Columns of a row with contributions, in ascending order.
  void columns_of(int row, std::vector<int>* columns) const;
  /// Moments of one of these columns.
  const Moments& at(int column, int row) const {
    return cells_[slots_[slot_index(column, row)] - 1];
  }

  /// Moments across a row of the arcs left of the window, by P_b.
  std::array<std::int64_t, N + 1> left_of(int row) const;

  /// Clears the cells. The columns of each row must have been read.
  void clear();

 private:
  static constexpr int kBlock = 16;

  // Calls use(index into slots_) for the cells of a row, from left to right.
  template <typename Use>
  void for_slots(int row, const Use& use) const;
  std::size_t slot_index(int column, int row) const {
    return static_cast<std::size_t>(row - window_.first_row) * blocks_ * kBlock +
           (column - window_.first_column);
  }
  // Index of a cell in cells_; allocates it if necessary.
  std::int32_t cell(int column, int row);
  std::int32_t cell_in_slot(int row, std::int32_t* slot);
  void reset_used_range() {
    first_used_row_ = window_.end_row;
    end_used_row_ = window_.first_row;
    first_used_block_ = blocks_;
    end_used_block_ = 0;
  }

  GridWindow window_;
  int first_used_row_ = 0;
  int end_used_row_ = 0;
  int blocks_ = 0;
  int first_used_block_ = 0;  // within a row
  int end_used_block_ = 0;
  std::vector<std::int32_t> slots_;     // index into cells_ plus one, or 0
  std::vector<std::uint16_t> touched_;  // bit mask of each block's columns that have a cell
  std::vector<std::int32_t> left_;      // of each row, as in slots_
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
