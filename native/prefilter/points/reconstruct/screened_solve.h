// SPDX-License-Identifier: GPL-3.0-or-later

// Solves for the function that agrees best with the samples, where these contradict each other.
//
// The function's means over neighboring cells differ by the flux, through the surface in them, of a
// hat function over both. Haar coefficients integrate these differences along the axes, which is
// exact where the surface is closed. Noise, gaps and misaligned scans leave differences that no
// function satisfies. Not in the dissertation: this finds the least-squares solution of
//
//   sum over faces of w (u_j - u_i - d_ij)^2 + screening * sum over cells of area (u(p) - 1/2)^2
//
// with u(p) interpolated at the mean sample p of a cell (screened Poisson reconstruction, Kazhdan
// and Hoppe 2013, in cells of their own size). For an exact surface the wavelets' function solves
// this except for the screening, so it is the initial value and a few iterations per depth suffice.
#pragma once

#include <cstddef>
#include <vector>

#include "prefilter/points/reconstruct/flux_tree.h"
#include "prefilter/wavelet/cell_tree.h"

namespace prefilter {

/// Origin of a block of an assembled tree.
struct BlockSource {
  const NodeLevel* level;
  std::size_t block;
};
using BlockSources = std::vector<std::vector<BlockSource>>;

/// Solves depth by depth for the cells deeper than `first`; larger leaves keep their values.
/// `target` is the value wanted at samples: 1/2, or -1/2 where the function is negative inside.
void solve_screened(const BlockSources& sources, int first, float target, CellTree* tree);

}  // namespace prefilter
