// SPDX-License-Identifier: GPL-3.0-or-later

// Detects isolated points.
#pragma once

#include <span>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/base/run.h"

namespace prefilter {

/// Marks as outliers the points whose mean distance to their `neighbours` nearest positions exceeds
/// `factor` times the median of that distance over these neighbors. The test is local, so sparsely
/// scanned parts are kept.
///
/// Copies of a point count once, and share its result. Points with a value that is not finite, or
/// above 1e150, are outliers; with fewer than three other positions no point is. The result is the
/// same for any number of threads. Throws Error for more than 2^31 - 1 points, neighbours outside 3
/// to 1000, or a factor that is not above 1 and finite; Error(kCancelled).
std::vector<bool> find_outliers(std::span<const Vector3> points, int neighbours, double factor,
                                const Run& run);

}  // namespace prefilter
