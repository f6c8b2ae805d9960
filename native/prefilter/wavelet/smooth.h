// SPDX-License-Identifier: GPL-3.0-or-later

// Smoothing of functions on octrees (section 4.3.1).
#pragma once

#include "prefilter/wavelet/cell_tree.h"

namespace prefilter {

/// Convolves with (1/4, 1/2, 1/4) along each axis: every leaf with its 26 neighbors of the same
/// depth. Where there is none, the larger leaf that holds it stands for it; outside of the root the
/// function is 0. Cells that are split keep their values.
void smooth_leaves(CellTree* tree);

}  // namespace prefilter
