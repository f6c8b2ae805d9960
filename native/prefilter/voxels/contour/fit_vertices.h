// SPDX-License-Identifier: GPL-3.0-or-later

// The interpolant "plane": moves vertices to the surface that preserves the volume of the
// neighboring cells.
#pragma once

#include "prefilter/base/run.h"
#include "prefilter/voxels/contour/surface_vertices.h"

namespace prefilter {

/// Occupancies within this distance of 1/2 do not determine the side of their cell's center.
inline constexpr float kDoubt = 0.05F;

/// Assigns leaves with occupancies close to 1/2 to the side of their center, by height_over_center:
/// on curved surfaces the two differ, and triangles between such a center and the surface would be
/// inside out. Throws Error(kCancelled).
void settle_sides(const Run& run, ContourTree* tree);

/// Moves vertices along their lines to where height_crossing finds the surface; other vertices
/// stay. Throws Error(kCancelled).
void fit_vertices(const ContourTree& tree, const RootFrame& frame, const Run& run,
                  SurfaceVertices* vertices);

}  // namespace prefilter
