// SPDX-License-Identifier: GPL-3.0-or-later

// Occupancy octrees whose surface is in cells of one size.
#pragma once

#include "prefilter/base/progress.h"
#include "prefilter/wavelet/cell_tree.h"

namespace prefilter {

/// Whether the surface passes through leaves that are coarser than the finest cells: there is an
/// occupancy between 0 and 1 above the last level.
bool has_coarse_surface(const CellTree& tree);

/// A tree in which the surface passes through cells of `depth` alone: coarser leaves that are
/// neither full nor empty are split to where their LeafSurface puts the surface, and so are full
/// ones beside empty ones. Leaves keep their occupancy, as the mean of what they are split to;
/// those of depth or finer stay as they are. Leaves whose neighbors fix no surface keep their
/// occupancy everywhere, and are split where another begins.
///
/// Preconditions: occupancies in [0, 1], and a depth up to kMaxTreeDepth. Throws Error(kCancelled).
CellTree refined(const CellTree& tree, int depth, const Progress& progress, int threads);

}  // namespace prefilter
