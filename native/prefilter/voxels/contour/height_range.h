// SPDX-License-Identifier: GPL-3.0-or-later

// Ranges of heights of a contour.
#pragma once

#include <limits>

namespace prefilter {

/// Heights from `low` up to, but not including, `high`, in cells of a tree's depth; the root lies
/// between 0 and 2^depth.
struct HeightRange {
  int low = std::numeric_limits<int>::min();
  int high = std::numeric_limits<int>::max();

  bool holds(int z) const { return z >= low && z < high; }
};

}  // namespace prefilter
