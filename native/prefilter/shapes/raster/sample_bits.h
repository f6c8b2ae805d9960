// SPDX-License-Identifier: GPL-3.0-or-later

// The samples of a cell that a layer fills: winding numbers on a fine grid, as bit masks.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "prefilter/shapes/raster/row_layers.h"

namespace prefilter {

/// One word per row of samples, from the lowest, with one bit per column.
using SampleRows = std::array<std::uint64_t, 64>;

/// No two samples of a cell have the same height or the same horizontal position: rows are shifted
/// along x by fractions of a column, and columns along y by fractions of a row, in permuted orders
/// that no edge can follow. For steep edges only the first shift matters and for flat edges only
/// the second, so edges are processed row by row or column by column. For edges of any direction,
/// the area is off by less than 1/380 of a cell, and by 1/1870 in the root mean square.
class SampleBits {
 public:
  static constexpr int kSide = 64;
  static constexpr int kCount = kSide * kSide;

  /// The samples between two heights, given by the number of samples below each.
  struct Band {
    int low = 0;
    int high = 0;

    int first_row() const { return low / kSide; }
    int end_row() const { return (high + kSide - 1) / kSide; }
    /// The columns of a row that are inside.
    std::uint64_t columns(int row) const;
  };

  explicit SampleBits(const StackArcs& stack_arcs) : stack_arcs_(stack_arcs) {}

  /// The samples that a layer fills in a cell with this center; valid until the next call.
  const SampleRows& fill(const CellLayer& layer, const Point2& center);

 private:
  template <typename Use>
  void for_lines(const StackArc& arc, const Point2& center, const Use& use) const;
  void fill_odd(const CellLayer& layer, const Point2& center);
  void fill_by_winding(const CellLayer& layer, const Point2& center, int bits);
  void add_winding(const Band& band, std::int32_t winding);

  const StackArcs& stack_arcs_;
  SampleRows filled_{};
  // Bit planes of the winding numbers, from the lowest bit.
  std::vector<SampleRows> planes_;
  SampleRows right_{};  // samples to the right of the current line, in its band
};

}  // namespace prefilter
