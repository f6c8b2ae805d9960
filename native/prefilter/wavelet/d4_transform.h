// SPDX-License-Identifier: GPL-3.0-or-later

// D4 coefficients of sampled surfaces, and the functions that they define (section 4.2).
//
// Let s_j(k) be the mean of the indicator function weighted by phi(2^j x - k). The divergence
// theorem expresses the difference s_j(k) - s_j(k + e_a) as the flux along axis a of the compactly
// supported function lambda(x_a) times phi of the other coordinates, where lambda'(t) = phi(t) -
// phi(t - 1). Only these differences at the finest depth are computed from the samples. Coarser
// differences follow by the refinement relation, and so do the wavelet coefficients by the
// symmetric F of the text, the mean over the axes of the wavelet of sums of differences. The result
// equals the printed sums over all samples at all depths.
#pragma once

#include <array>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/base/run.h"
#include "prefilter/wavelet/brick_grid.h"
#include "prefilter/wavelet/cell_tree.h"

namespace prefilter::d4 {

/// Differences along the axes, at one depth.
using Differences = BrickGrid<3>;
/// Means s_j, at one depth.
using Means = BrickGrid<1>;

inline constexpr int kShardBits = 4;  // shards are 16 bricks or 64 points high

/// Adds a sample: `point` in cells of the grid's depth, `area` its normal times its area in squared
/// cell sides.
void add_sample(const Vector3& point, const std::array<float, 3>& area, Differences* differences);

/// Computes the means of all depths from 0 on, from differences at all depths: the caller may add
/// coarse samples directly to coarse differences. The means are computed in the bricks `needed[k]`
/// of depth k, and in the bricks that these depend on. Throws Error(kCancelled).
std::vector<Means> transform(std::vector<Differences> differences,
                             std::vector<std::vector<BrickPosition>> needed, const Run& run);

/// The function at the centers of a brick's cells, [z][y][x]: the sum of means times phi.
std::array<float, 64> function_at(const Means& means, const BrickPosition& brick);

}  // namespace prefilter::d4
