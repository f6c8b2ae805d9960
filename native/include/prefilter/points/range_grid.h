// SPDX-License-Identifier: GPL-3.0-or-later

// The grid of a range scanner.
#pragma once

#include <cstdint>
#include <vector>

namespace prefilter {

/// The points of a range scan on its scanner's grid. Neighbors in the grid are neighbors on the
/// surface, or on opposite sides of a depth discontinuity.
struct RangeGrid {
  std::int64_t rows = 0;
  std::int64_t columns = 0;
  /// Row by row, the index of a point, or -1 for a miss.
  std::vector<std::int64_t> points;
};

}  // namespace prefilter
