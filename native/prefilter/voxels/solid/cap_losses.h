// SPDX-License-Identifier: GPL-3.0-or-later

// Caps that would take away from what a mesh encloses.
#pragma once

#include <span>

#include "prefilter/base/geometry.h"
#include "prefilter/base/progress.h"
#include "prefilter/voxels/solid/border_loops.h"
#include "prefilter/voxels/solid/loop_caps.h"
#include "prefilter/voxels/solid/sheets.h"

namespace prefilter {

/// Of the loops of solid parts drops those whose caps would cancel the surface: where other parts
/// close them already, as what is behind the cap is inside without it, and where the cap is inside
/// out. `is_kept` has an entry for each loop.
void leave_losses(const InputMesh& mesh, const BorderLoops& loops, std::span<const LoopCap> caps,
                  const CappedSolids& solids, const Progress& progress, int threads,
                  std::span<unsigned char> is_kept);

}  // namespace prefilter
