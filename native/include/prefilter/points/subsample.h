// SPDX-License-Identifier: GPL-3.0-or-later

// Fewer points, evenly spread.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/base/names.h"
#include "prefilter/base/progress.h"

namespace prefilter {

enum class Subsampling { kPoisson, kGrid };

inline constexpr Named<Subsampling> kSubsamplingNames[] = {
    {"poisson", Subsampling::kPoisson},
    {"grid", Subsampling::kGrid},
};

/// The indices of the points that are kept, ascending.
///
/// kPoisson: no two that are kept are nearer to each other than `spacing`, and each that is left
/// out is nearer than that to one that is kept. They are visited in an order that only looks
/// random, and that does not depend on the order of the points. kGrid: of the points in each cell
/// of a grid, `spacing` wide, the one nearest to their mean, the first of several.
///
/// Points that hold a value that is not finite, or above 1e150, are left out; of points at one
/// position the first is kept. The same for any number of threads. Throws Error for more than 2^31
/// - 1 points, or a spacing that is not above 0, not finite, or a 1e15th of the points' extent or
/// less; Error(kCancelled).
std::vector<std::int64_t> subsample(std::span<const Vector3> points, double spacing,
                                    Subsampling method, const Progress& progress, int threads);

}  // namespace prefilter
