// SPDX-License-Identifier: GPL-3.0-or-later

// A sparse grid of cells; section 2.2.1 defines the moments.
#include "prefilter/shapes/raster/moment_cells.h"

#include <algorithm>
#include <bit>

namespace prefilter {

template <int N>
void MomentCells<N>::begin_band(const CellFilter& filter, int width, int first_row, int end_row) {
  clear();
  window_ = {filter.first_cell(0), filter.first_cell(width - 1) + filter.taps,
             filter.first_cell(first_row), filter.first_cell(end_row - 1) + filter.taps};
  blocks_ = (window_.end_column - window_.first_column) / kBlock + 1;
  const std::size_t rows = window_.end_row - window_.first_row;
  // All values are 0, so rows of another length only need enough memory.
  const std::size_t blocks = rows * blocks_;
  if (touched_.size() < blocks) touched_.resize(blocks);
  if (slots_.size() < blocks * kBlock) slots_.resize(blocks * kBlock);
  if (left_.size() < rows) left_.resize(rows);
  reset_used_range();
}

template <int N>
std::int32_t MomentCells<N>::cell_in_slot(int row, std::int32_t* slot) {
  if (*slot == 0) {
    cells_.emplace_back();
    *slot = static_cast<std::int32_t>(cells_.size());
    first_used_row_ = std::min(first_used_row_, row);
    end_used_row_ = std::max(end_used_row_, row + 1);
  }
  return *slot - 1;
}

template <int N>
std::int32_t MomentCells<N>::cell(int column, int row) {
  const std::size_t slot = slot_index(column, row);
  const int block = (column - window_.first_column) / kBlock;
  first_used_block_ = std::min(first_used_block_, block);
  end_used_block_ = std::max(end_used_block_, block + 1);
  touched_[slot / kBlock] |= static_cast<std::uint16_t>(1U << slot % kBlock);
  return cell_in_slot(row, &slots_[slot]);
}

template <int N>
template <typename Use>
void MomentCells<N>::for_slots(int row, const Use& use) const {
  const std::size_t first = slot_index(window_.first_column, row) / kBlock;
  for (std::size_t block = first + first_used_block_; block < first + end_used_block_; ++block) {
    for (unsigned bits = touched_[block]; bits != 0; bits &= bits - 1) {
      use(block * kBlock + static_cast<std::size_t>(std::countr_zero(bits)));
    }
  }
}

template <int N>
void MomentCells<N>::add(const MonotoneCurve& piece, int sign) {
  const auto left_of_window = [&](int row, double y_begin, double y_end) {
    const std::int32_t slot = cell_in_slot(row, &left_[row - window_.first_row]);
    const double center = row + 0.5;
    batch_.add_line({0.0, y_begin - center}, {0.0, y_end - center}, sign, slot, &cells_);
  };
  if (piece.curve.kind == CurveKind::kLine) {
    cut_line_to_cells(
        piece.begin, piece.end, window_,
        [&](int column, int row, Point2 begin, Point2 end) {
          const Point2 center{column + 0.5, row + 0.5};
          batch_.add_line(begin - center, end - center, sign, cell(column, row), &cells_);
        },
        left_of_window);
    return;
  }
  cut_to_cells(
      piece, window_,
      [&](int column, int row, const CellArc& arc) {
        batch_.add_curve(piece.curve, arc, {column + 0.5, row + 0.5}, sign, cell(column, row),
                         &cells_);
      },
      left_of_window);
}

template <int N>
void MomentCells<N>::columns_of(int row, std::vector<int>* columns) const {
  columns->clear();
  const std::size_t first = slot_index(window_.first_column, row);
  for_slots(row, [&](std::size_t slot) {
    if (cells_[slots_[slot] - 1].is_zero()) return;
    columns->push_back(window_.first_column + static_cast<int>(slot - first));
  });
}

template <int N>
std::array<std::int64_t, N + 1> MomentCells<N>::left_of(int row) const {
  std::array<std::int64_t, N + 1> across{};
  const std::int32_t slot = left_[row - window_.first_row];
  for (int b = 0; slot != 0 && b <= N; ++b) across[b] = cells_[slot - 1].across(b);
  return across;
}

template <int N>
void MomentCells<N>::clear() {
  for (int row = first_used_row_; row < end_used_row_; ++row) {
    left_[row - window_.first_row] = 0;
    for_slots(row, [&](std::size_t slot) {
      slots_[slot] = 0;
      touched_[slot / kBlock] = 0;
    });
  }
  cells_.clear();
  reset_used_range();
}

template class MomentCells<0>;
template class MomentCells<1>;
template class MomentCells<2>;
template class MomentCells<3>;
template class MomentCells<4>;
template class MomentCells<5>;
template class MomentCells<7>;
template class MomentCells<8>;
template class MomentCells<9>;

}  // namespace prefilter
