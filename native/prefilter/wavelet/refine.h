// SPDX-License-Identifier: GPL-3.0-or-later

// Refines occupancy octrees along their surface to cells of one size.
#pragma once

#include "prefilter/base/run.h"
#include "prefilter/wavelet/cell_tree.h"

namespace prefilter {

/// Whether the surface passes through leaves coarser than the finest cells: an occupancy strictly
/// between 0 and 1 occurs above the last level.
bool has_coarse_surface(const CellTree& tree);

/// A refined tree in which the surface only passes through cells of `depth`. Coarser leaves that
/// are partly full are split along their LeafSurface, and so are full leaves beside empty ones. The
/// occupancy of each split leaf is preserved as the mean of its parts. Leaves of that depth or
/// finer do not change. Leaves whose neighbors determine no surface get a uniform occupancy, and
/// are split where they border on other values.
///
/// Preconditions: occupancies in [0, 1], and a depth up to kMaxTreeDepth. Throws Error(kCancelled).
CellTree refined(const CellTree& tree, int depth, const Run& run);

}  // namespace prefilter
