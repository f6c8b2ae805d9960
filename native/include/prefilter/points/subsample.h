// SPDX-License-Identifier: GPL-3.0-or-later

// Subsampling to evenly spread points.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/base/names.h"
#include "prefilter/base/run.h"

namespace prefilter {

enum class Subsampling { kPoisson, kGrid };

inline constexpr Named<Subsampling> kSubsamplingNames[] = {
    {"poisson", Subsampling::kPoisson},
    {"grid", Subsampling::kGrid},
};

/// Returns the indices of the retained points in ascending order.
///
/// kPoisson: no two retained points are closer than `spacing`, and every other point is closer than
/// that to a retained one. Points are visited in a pseudorandom order that is independent of their
/// order in the input. kGrid: in each cell of a grid, `spacing` wide, the point nearest to the mean
/// of the cell's points, the first of several.
///
/// Points with a value that is not finite, or above 1e150, are left out; of coincident points the
/// first is used. The result is the same for any number of threads. Throws Error for more than 2^31
/// - 1 points, or a spacing that is not above 0, not finite, or at most 1e-15 of the points'
/// extent; Error(kCancelled).
std::vector<std::int64_t> subsample(std::span<const Vector3> points, double spacing,
                                    Subsampling method, const Run& run);

}  // namespace prefilter
