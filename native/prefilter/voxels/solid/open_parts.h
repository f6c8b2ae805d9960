// SPDX-License-Identifier: GPL-3.0-or-later

// Repairs patches that are open or too thin.
#pragma once

#include "prefilter/base/run.h"
#include "prefilter/voxels/as_solid.h"
#include "prefilter/voxels/solid/patches.h"
#include "prefilter/voxels/solid/weld.h"

namespace prefilter {

/// Orients open patches toward the outside, and replaces those that enclose nothing by the surface
/// of a region that the outside does not reach, or by shells. The triangles of `mesh` must be those
/// of `patches`, oriented as found. Returns whether anything changed.
bool repair_open_parts(const Patches& patches, const SolidOptions& options, const Run& run,
                       WorkMesh* mesh, SolidReport* report);

}  // namespace prefilter
