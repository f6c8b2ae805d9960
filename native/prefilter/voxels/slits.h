// SPDX-License-Identifier: GPL-3.0-or-later

// Opens slits of a solid that cells bridge.
#pragma once

#include "prefilter/base/run.h"
#include "prefilter/geometry/spatial/winding_numbers.h"
#include "prefilter/wavelet/cell_tree.h"

namespace prefilter {

/// Lowers cells slightly above 1/2 to slightly below it if only they connect full cells across
/// empty ones, while the mesh does not connect these: otherwise slits narrower than cells become
/// rows of holes. `winding` holds the mesh's winding numbers, in units of `unit` cells. Thickened
/// cells are kept. Throws Error(kCancelled).
void open_slits(const WindingNumbers& winding, double unit, const CellTree& thickened, int depth,
                const Run& run, CellTree* cells);

}  // namespace prefilter
