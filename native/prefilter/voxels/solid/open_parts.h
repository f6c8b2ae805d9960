// SPDX-License-Identifier: GPL-3.0-or-later

// What becomes of patches that are not closed, or too thin.
#pragma once

#include "prefilter/base/progress.h"
#include "prefilter/voxels/as_solid.h"
#include "prefilter/voxels/solid/patches.h"
#include "prefilter/voxels/solid/weld.h"

namespace prefilter {

/// Turns patches so that they have their outside where the outside is, and replaces those that wind
/// around nothing: by the surface of what the outside does not reach, or by shells. The triangles
/// of `mesh` are those that `patches` were found of, turned as they say. Returns whether anything
/// changed.
bool mend_open_parts(const Patches& patches, const SolidOptions& options, const Progress& progress,
                     WorkMesh* mesh, SolidReport* report);

}  // namespace prefilter
