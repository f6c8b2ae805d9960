// SPDX-License-Identifier: GPL-3.0-or-later

// Octrees that are fine where their shape is cut off.
#pragma once

#include "prefilter/base/progress.h"
#include "prefilter/wavelet/cell_tree.h"

namespace prefilter {

/// A tree in which leaves above 0 that touch a face of the root are of its finest depth. Throws
/// Error(kCancelled).
CellTree with_fine_border(const CellTree& tree, const Progress& progress, int threads);

}  // namespace prefilter
