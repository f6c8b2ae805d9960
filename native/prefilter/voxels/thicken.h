// SPDX-License-Identifier: GPL-3.0-or-later

// Occupancies of what is added where a solid is thin.
#pragma once

#include "prefilter/base/progress.h"
#include "prefilter/voxels/octree.h"
#include "prefilter/wavelet/triangle_analysis.h"

namespace prefilter {

/// Makes a solid as thick as `thickness`, in cells of the octree's depth, wherever it is thinner.
/// `mesh` is what the octree was made of. The finest cells that change are those of
/// `octree->thickened`; where the mesh is thin, `octree->thin` says.
void thicken(const RootTriangles& mesh, double thickness, const Progress& progress, int threads,
             Octree* octree);

}  // namespace prefilter
