// SPDX-License-Identifier: GPL-3.0-or-later

// Heights of a surface over columns of occupancies.
#pragma once

#include <optional>

namespace prefilter {

/// Mean height of the surface above the low side of a column's cell, in cells: the sum of the
/// occupancies between full and empty cells. `value(i)` is the occupancy of the cell i steps toward
/// the empty end. Nothing if the column does not go from full to empty within a few cells.
template <typename Value>
std::optional<float> column_height(const Value& value) {
  constexpr float kMinFull = 1.0F - 1e-5F;
  constexpr float kMaxEmpty = 1e-5F;
  constexpr int kMaxColumnSteps = 4;
  float height = 0.0F;
  for (int i = 0;; ++i) {
    const float occupancy = value(i);
    if (!(occupancy > kMaxEmpty)) break;
    if (i == kMaxColumnSteps) return std::nullopt;
    height += occupancy;
  }
  for (int i = -1;; --i) {
    const float occupancy = value(i);
    if (!(occupancy < kMinFull)) break;
    if (i == -1 - kMaxColumnSteps) return std::nullopt;
    height -= 1.0F - occupancy;
  }
  return height;
}

}  // namespace prefilter
