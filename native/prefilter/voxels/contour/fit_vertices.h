// SPDX-License-Identifier: GPL-3.0-or-later

// The interpolant "plane": vertices moved to the surface that preserves the volume of the
// neighboring cells.
#pragma once

#include "prefilter/base/progress.h"
#include "prefilter/voxels/contour/surface_vertices.h"

namespace prefilter {

/// Occupancies this close to 1/2 do not tell which side their cell's center is on.
inline constexpr float kDoubt = 0.05F;

/// Puts leaves whose occupancy is close to 1/2 on the side that their center is on, by
/// height_over_center: on a curved surface the two differ, and triangles between such a center and
/// the surface would be inside out. Throws Error(kCancelled).
void settle_sides(const Progress& progress, int threads, ContourTree* tree);

/// Moves vertices along their lines to where height_crossing finds the surface; where it finds
/// none they stay. Throws Error(kCancelled).
void fit_vertices(const ContourTree& tree, const RootFrame& frame, const Progress& progress,
                  int threads, SurfaceVertices* vertices);

}  // namespace prefilter
