// SPDX-License-Identifier: GPL-3.0-or-later

// Subdivides unit cells along one axis, and cuts pieces at the subdivisions.
#pragma once

#include <cmath>
#include <vector>

#include "prefilter/geometry/moments/triangle_cells.h"

namespace prefilter {

/// The parts [low, low + width) of unit cells along an axis, numbered from 0.
class AxisParts {
 public:
  AxisParts() = default;
  /// Uses lines [first_line, last_line] of `lines`, multiplied by `scale`. They must include every
  /// whole number from the first to the last.
  AxisParts(const std::vector<double>& lines, int first_line, int last_line, double scale);

  int count() const { return static_cast<int>(widths_.size()); }
  double low(int part) const { return lows_[part]; }
  double width(int part) const { return widths_[part]; }
  /// The first part of a cell; cells are numbered from 0.
  int first_of(int cell) const { return first_of_[cell]; }
  int parts_of(int cell) const { return first_of_[cell + 1] - first_of_[cell]; }

  /// Cuts a piece in a cell, and calls use(part, piece) for each part with some of it. A piece
  /// without extent along the axis belongs to a single part.
  template <typename Use>
  void cut(const CellPiece& piece, int axis, int cell, const Use& use) const;

 private:
  std::vector<int> first_of_;
  std::vector<double> lows_;
  std::vector<double> widths_;
};

template <typename Use>
void AxisParts::cut(const CellPiece& piece, int axis, int cell, const Use& use) const {
  CellPiece rest = piece;
  const int last = first_of_[cell + 1] - 1;
  for (int part = first_of_[cell]; part < last; ++part) {
    const double line = lows_[part + 1];
    double low = HUGE_VAL;
    double high = -HUGE_VAL;
    for (int i = 0; i < rest.count; ++i) {
      const double at = axis == 0 ? rest.corners[i].x : rest.corners[i].y;
      low = std::min(low, at);
      high = std::max(high, at);
    }
    if (low >= line) continue;
    if (high <= line) {
      use(part, rest);
      return;
    }
    CellPiece below;
    CellPiece above;
    split_piece(rest, axis, line, &below, &above);
    use(part, below);
    rest = above;
  }
  use(last, rest);
}

}  // namespace prefilter
