// SPDX-License-Identifier: GPL-3.0-or-later

// Vertices of quads moved along a surface, so that quads are regular.
#pragma once

#include <vector>

#include "prefilter/base/progress.h"
#include "prefilter/voxels/contour/dual_loops.h"
#include "prefilter/voxels/contour/dual_places.h"

namespace prefilter {

/// Moves the vertices that are not sharp toward the mean of those beside them, along the surface
/// and within their loops. The surface is that through a vertex and its loop's corners, which have
/// these positions and unit normals: right to second order, as where the vertices are at first.
/// Throws Error(kCancelled).
void relax_places(const DualLoops& loops, const std::vector<Vector3>& positions,
                  const std::vector<Vector3>& normals, const Progress& progress, int threads,
                  DualPlaces* places);

}  // namespace prefilter
