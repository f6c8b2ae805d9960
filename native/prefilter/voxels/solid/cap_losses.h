// SPDX-License-Identifier: GPL-3.0-or-later

// Finds caps that would reduce the volume that a mesh encloses.
#pragma once

#include <span>

#include "prefilter/base/geometry.h"
#include "prefilter/base/run.h"
#include "prefilter/voxels/solid/border_loops.h"
#include "prefilter/voxels/solid/loop_caps.h"
#include "prefilter/voxels/solid/sheets.h"

namespace prefilter {

/// Clears `is_kept` for loops of solid parts whose caps would cancel the surface: because other
/// parts close them already, so that the region behind the cap is inside without it, or because the
/// cap is inside out. `is_kept` has one entry per loop.
void drop_canceling_caps(const InputMesh& mesh, const BorderLoops& loops,
                         std::span<const LoopCap> caps, const CappedSolids& solids, const Run& run,
                         std::span<unsigned char> is_kept);

}  // namespace prefilter
