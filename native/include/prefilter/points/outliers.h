// SPDX-License-Identifier: GPL-3.0-or-later

// Points that lie by themselves.
#pragma once

#include <span>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/base/progress.h"

namespace prefilter {

/// Which points are outliers: those whose mean distance to the `neighbours` positions nearest to
/// them is more than `factor` times the median of those of these neighbors. What a cloud has
/// elsewhere says nothing, so parts that were scanned sparsely stay.
///
/// Copies of a point count once, and are what it is. Points that hold a value that is not finite,
/// or above 1e150, are outliers; of fewer than three other positions none is. The same for any
/// number of threads. Throws Error for more than 2^31 - 1 points, neighbours not from 3 to 1000, or
/// a factor that is not above 1 and finite; Error(kCancelled).
std::vector<bool> find_outliers(std::span<const Vector3> points, int neighbours, double factor,
                                const Progress& progress, int threads);

}  // namespace prefilter
