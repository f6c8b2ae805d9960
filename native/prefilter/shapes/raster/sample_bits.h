// SPDX-License-Identifier: GPL-3.0-or-later

// Which samples of a cell a layer fills: winding numbers on a fine grid, in bits.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "prefilter/shapes/raster/row_layers.h"

namespace prefilter {

/// A word a row of samples, from the lowest, and in it a bit a column.
using SampleRows = std::array<std::uint64_t, 64>;

/// No two samples of a cell are at the same height, nor beside each other at the same place: rows
/// are shifted along x by parts of a column, and columns along y by parts of a row, both in orders
/// that no edge has. To steep edges only the first counts, to others only the second, so that they
/// are cut row by row, or column by column. An edge of any direction is off by less than 1/380 of a
/// cell, and by 1/1870 in the root mean square.
class SampleBits {
 public:
  static constexpr int kSide = 64;
  static constexpr int kCount = kSide * kSide;

  /// What lies between two heights, as numbers of the samples below them.
  struct Band {
    int low = 0;
    int high = 0;

    int first_row() const { return low / kSide; }
    int end_row() const { return (high + kSide - 1) / kSide; }
    /// The columns of a row that are in it.
    std::uint64_t columns(int row) const;
  };

  explicit SampleBits(const StackArcs& stack_arcs) : stack_arcs_(stack_arcs) {}

  /// The samples that a layer fills in a cell with this center, valid until the next call.
  const SampleRows& fill(const CellLayer& layer, const Point2& center);

 private:
  template <typename Use>
  void for_lines(const StackArc& arc, const Point2& center, const Use& use) const;
  void fill_odd(const CellLayer& layer, const Point2& center);
  void fill_wound(const CellLayer& layer, const Point2& center, int bits);
  void add_winding(const Band& band, std::int32_t winding);

  const StackArcs& stack_arcs_;
  SampleRows filled_{};
  // Winding numbers: a bit of each a plane, from the lowest.
  std::vector<SampleRows> planes_;
  SampleRows right_{};  // what is right of the line in hand, in its band
};

}  // namespace prefilter
