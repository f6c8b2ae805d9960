// SPDX-License-Identifier: GPL-3.0-or-later

// D4 coefficients of sampled surfaces, and the function that they make (section 4.2).
//
// Let s_j(k) be the mean of the indicator function weighted by phi(2^j x - k). By the divergence
// theorem the difference s_j(k) - s_j(k + e_a) is the flux, along axis a, of lambda in x_a times
// phi in the others, where lambda' (t) = phi(t) - phi(t - 1); its support is compact. These
// differences of the finest depth are all that is taken from the samples: those of coarser depths,
// and the wavelet coefficients by the symmetric F of the text (the mean over the axes of the
// wavelet, of sums of differences), follow by the refinement relation. The printed sums over all
// samples at all depths give the same numbers.
#pragma once

#include <array>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/base/progress.h"
#include "prefilter/wavelet/brick_grid.h"
#include "prefilter/wavelet/cell_tree.h"

namespace prefilter::d4 {

/// Differences along the axes, of one depth.
using Differences = BrickGrid<3>;
/// Means s_j, of one depth.
using Means = BrickGrid<1>;

inline constexpr int kShardBits = 4;  // bricks: 64 points

/// Adds a sample: `point` in cells of the grid's depth, its normal times its area in sides of a
/// cell squared.
void add_sample(const Vector3& point, const std::array<float, 3>& area, Differences* differences);

/// From the differences of all depths (to which coarser samples may have been added, at theirs) to
/// the means of all depths from 0 on: in the bricks `needed[k]` of depth k, and in those that these
/// depend on. Throws Error(kCancelled).
std::vector<Means> transform(std::vector<Differences> differences,
                             std::vector<std::vector<BrickPosition>> needed,
                             const Progress& progress, int threads);

/// The function at the centers of the cells of a brick, [z][y][x]: the sum of means times phi.
std::array<float, 64> function_at(const Means& means, const BrickPosition& brick);

}  // namespace prefilter::d4
