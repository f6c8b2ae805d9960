// SPDX-License-Identifier: GPL-3.0-or-later

// Slits of a solid that cells bridge.
#pragma once

#include "prefilter/base/progress.h"
#include "prefilter/geometry/spatial/winding_numbers.h"
#include "prefilter/wavelet/cell_tree.h"

namespace prefilter {

/// Makes cells a little less than half full that are a little more, alone join full cells across
/// empty ones, and in which the mesh does not: slits narrower than cells come out as holes where
/// some are empty and others are not. `winding` is the mesh's, in units of so many cells. What is
/// thickened stays. Throws Error(kCancelled).
void open_slits(const WindingNumbers& winding, double unit, const CellTree& thickened, int depth,
                const Progress& progress, int threads, CellTree* cells);

}  // namespace prefilter
