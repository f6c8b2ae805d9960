// SPDX-License-Identifier: GPL-3.0-or-later

// The places at which a scanner saw its points.
#pragma once

#include <cstdint>
#include <vector>

namespace prefilter {

/// The points of a range scan as its scanner saw them. Those of neighboring places are neighbors
/// on the surface, or on both sides of an edge that hides one from the other.
struct RangeGrid {
  std::int64_t rows = 0;
  std::int64_t columns = 0;
  /// Row by row the index of a point, or -1 where the scanner saw nothing.
  std::vector<std::int64_t> points;
};

}  // namespace prefilter
