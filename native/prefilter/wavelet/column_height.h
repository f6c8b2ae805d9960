// SPDX-License-Identifier: GPL-3.0-or-later

// The height of a surface over columns of occupancies.
#pragma once

#include <optional>

namespace prefilter {

/// The mean height of the surface over the low side of a column's cell, in cells: the sum of the
/// occupancies between full and empty cells. `value(i)` is that of the cell i steps toward the
/// empty end. None where the column does not run from full to empty within a few cells.
template <typename Value>
std::optional<float> column_height(const Value& value) {
  constexpr float kFull = 1.0F - 1e-5F;
  constexpr float kEmpty = 1e-5F;
  constexpr int kMostSteps = 4;
  float height = 0.0F;
  for (int i = 0;; ++i) {
    const float occupancy = value(i);
    if (!(occupancy > kEmpty)) break;
    if (i == kMostSteps) return std::nullopt;
    height += occupancy;
  }
  for (int i = -1;; --i) {
    const float occupancy = value(i);
    if (!(occupancy < kFull)) break;
    if (i == -1 - kMostSteps) return std::nullopt;
    height -= 1.0F - occupancy;
  }
  return height;
}

}  // namespace prefilter
