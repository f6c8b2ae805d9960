// SPDX-License-Identifier: GPL-3.0-or-later

// Fills pinholes in thickened regions.
#pragma once

#include "prefilter/base/run.h"
#include "prefilter/wavelet/cell_tree.h"

namespace prefilter {

/// Fills thickened cells that are nearly half full and have at least four of six face neighbors
/// that are more than half full; beside an edge or in a corner there are at most three. In a
/// contour at 1/2 such a cell would be a hole of one cell.
void fill_pinholes(const CellTree& thickened, int depth, const Run& run, CellTree* cells);

}  // namespace prefilter
