// SPDX-License-Identifier: GPL-3.0-or-later

// Paths to stroke, and their dashes.
#pragma once

#include <span>
#include <vector>

#include "prefilter/base/curve.h"

namespace prefilter {

/// Consecutive curves that are stroked as one path.
struct StrokePath {
  std::vector<PartOfCurve> curves;
  bool is_closed = false;
  /// Position and direction of the caps of a path without curves.
  Point2 point;
  Point2 direction{1.0, 0.0};
};

/// Arc length of a curve between two parameters.
double arc_length(const Curve& curve, double from, double to);

/// Appends the dashes along a path. `pattern` alternates dashes and gaps, an even number in all,
/// and the path starts at `offset` >= 0 in it. If a closed path begins and ends within a dash,
/// these two parts are joined.
void append_dashes(const StrokePath& path, std::span<const double> pattern, double offset,
                   std::vector<StrokePath>* dashes);

}  // namespace prefilter
