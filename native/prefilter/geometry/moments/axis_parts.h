// SPDX-License-Identifier: GPL-3.0-or-later

// Unit cells cut further along one axis, and pieces cut to the parts.
#pragma once

#include <cmath>
#include <vector>

#include "prefilter/geometry/moments/triangle_cells.h"

namespace prefilter {

/// The parts [low, low + width) of unit cells along an axis, numbered from 0.
class AxisParts {
 public:
  AxisParts() = default;
  /// Lines [first_line, last_line] of `lines`, times `scale`; every whole number from the first to
  /// the last must be among them.
  AxisParts(const std::vector<double>& lines, int first_line, int last_line, double scale);

  int count() const { return static_cast<int>(widths_.size()); }
  double low(int part) const { return lows_[part]; }
  double width(int part) const { return widths_[part]; }
  /// The first part of a cell, given from 0.
  int first_of(int cell) const { return first_of_[cell]; }
  int parts_of(int cell) const { return first_of_[cell + 1] - first_of_[cell]; }

  /// Calls use(part, piece) for what lies in each part of a cell. A piece without extent along the
  /// axis goes to one part.
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
