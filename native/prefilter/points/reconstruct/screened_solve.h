// SPDX-License-Identifier: GPL-3.0-or-later

// The function that agrees best with the samples, where these contradict each other.
//
// Between neighboring cells the function's means differ by the flux of a hat over the two through
// the surface in them; Haar coefficients integrate these differences along the axes, which gives
// the means exactly where the surface is closed. Noise, gaps and scans that are off leave
// differences that no function has. Beyond the text: the function sought is that of least squares
//
//   sum over faces of w (u_j - u_i - d_ij)^2 + screening * sum over cells of area (u(p) - 1/2)^2
//
// with u(p) at the mean sample p of a cell, between the cell's neighbors (screened Poisson
// reconstruction, Kazhdan and Hoppe 2013, in cells of their own size). Of an exact surface the
// wavelets' function is the solution but for the screening; so they start it, and a few steps for
// each depth are enough.
#pragma once

#include <cstddef>
#include <vector>

#include "prefilter/points/reconstruct/flux_tree.h"
#include "prefilter/wavelet/cell_tree.h"

namespace prefilter {

/// Where a block of a tree comes from.
struct BlockSource {
  const NodeLevel* level;
  std::size_t block;
};
using BlockSources = std::vector<std::vector<BlockSource>>;

/// Solves depth by depth for the cells of depths above `first`, where larger leaves have their
/// values already. `middle` is the value wanted at samples: 1/2, or -1/2 where the function is
/// below 0 inside.
void solve_screened(const BlockSources& sources, int first, float middle, CellTree* tree);

}  // namespace prefilter
