// SPDX-License-Identifier: GPL-3.0-or-later

// Removes folds and intersections of quads.
#pragma once

#include "prefilter/base/run.h"
#include "prefilter/voxels/contour/dual_loops.h"
#include "prefilter/voxels/contour/dual_places.h"
#include "prefilter/voxels/contour/edge_source.h"
#include "prefilter/voxels/contour/quad_surface.h"

namespace prefilter {

/// Builds quads between the loops at their positions. Where their triangles fold by more than 120
/// degrees, intersect or face the wrong way, vertices slide along their edges, or retreat toward
/// the centers of their loops and then to the safe positions. Throws Error(kCancelled).
QuadSurface settled_quads(const DualLoops& loops, const DualPlaces& places, const EdgeSource& edges,
                          const FeaturePlaces* features, const Vector3& cell, const Run& run);

}  // namespace prefilter
