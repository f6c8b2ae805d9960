// SPDX-License-Identifier: GPL-3.0-or-later

// Thickens thin parts of a solid.
#pragma once

#include "prefilter/base/run.h"
#include "prefilter/voxels/octree.h"
#include "prefilter/wavelet/triangle_analysis.h"

namespace prefilter {

/// Thickens a solid to `thickness`, in cells of the octree's depth, wherever it is thinner. `mesh`
/// is the mesh from which the octree was made. Stores the changed finest cells in
/// `octree->thickened` and the thin triangles in `octree->thin` and `octree->thin_walls`.
void thicken(const RootTriangles& mesh, double thickness, const Run& run, Octree* octree);

}  // namespace prefilter
