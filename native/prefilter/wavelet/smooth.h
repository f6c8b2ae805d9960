// SPDX-License-Identifier: GPL-3.0-or-later

// Smoothing of functions on octrees (section 4.3.1).
#pragma once

#include "prefilter/wavelet/cell_tree.h"

namespace prefilter {

/// Convolves every leaf with (1/4, 1/2, 1/4) along each axis, using its 26 neighbors of the same
/// depth. A missing neighbor has the value of the larger leaf that contains it, and 0 outside the
/// root. Split cells do not change.
void smooth_leaves(CellTree* tree);

}  // namespace prefilter
