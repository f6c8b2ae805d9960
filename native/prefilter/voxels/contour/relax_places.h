// SPDX-License-Identifier: GPL-3.0-or-later

// Moves vertices of quads along a surface to make the quads more regular.
#pragma once

#include <vector>

#include "prefilter/base/run.h"
#include "prefilter/voxels/contour/dual_loops.h"
#include "prefilter/voxels/contour/dual_places.h"

namespace prefilter {

/// Moves vertices that are not sharp toward the mean of their neighbors, along the surface and
/// within their loops. The surface passes through a vertex and its loop's corners, which have these
/// positions and unit normals; it is accurate to second order, like the initial positions. Throws
/// Error(kCancelled).
void relax_places(const DualLoops& loops, const std::vector<Vector3>& positions,
                  const std::vector<Vector3>& normals, const Run& run, DualPlaces* places);

}  // namespace prefilter
