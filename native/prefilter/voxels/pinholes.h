// SPDX-License-Identifier: GPL-3.0-or-later

// Holes that thickened places have for want of a little.
#pragma once

#include "prefilter/base/progress.h"
#include "prefilter/wavelet/cell_tree.h"

namespace prefilter {

/// Fills cells that are thickened and nearly half full between neighbors that are more than half
/// full: four of six, which beside an edge or in a corner are three at the most. Such a cell is a
/// hole as wide as itself where a contour is cut at a half.
void fill_pinholes(const CellTree& thickened, int depth, const Progress& progress, int threads,
                   CellTree* cells);

}  // namespace prefilter
