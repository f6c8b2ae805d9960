// SPDX-License-Identifier: GPL-3.0-or-later

// Refines octrees at the faces of the root.
#pragma once

#include "prefilter/base/run.h"
#include "prefilter/wavelet/cell_tree.h"

namespace prefilter {

/// A refined tree in which nonzero leaves that touch a face of the root have the finest depth.
/// Throws Error(kCancelled).
CellTree with_fine_border(const CellTree& tree, const Run& run);

}  // namespace prefilter
