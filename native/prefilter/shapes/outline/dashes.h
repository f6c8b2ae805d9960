// SPDX-License-Identifier: GPL-3.0-or-later

// Curves in a row, and their dashes.
#pragma once

#include <span>
#include <vector>

#include "prefilter/base/curve.h"

namespace prefilter {

/// A pen's way: curves, each from where the last one ends.
struct StrokePath {
  std::vector<PartOfCurve> curves;
  bool is_closed = false;
  /// What caps go by where there is no curve.
  Point2 point;
  Point2 direction{1.0, 0.0};
};

/// The arc length of a curve between two parameters.
double arc_length(const Curve& curve, double from, double to);

/// The dashes along a path: `pattern` is dashes and gaps in turns, an even number of them, and
/// begins `offset` >= 0 into it. Where a closed path begins and ends within dashes, they are one.
void append_dashes(const StrokePath& path, std::span<const double> pattern, double offset,
                   std::vector<StrokePath>* dashes);

}  // namespace prefilter
