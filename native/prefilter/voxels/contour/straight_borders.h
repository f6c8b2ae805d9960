// SPDX-License-Identifier: GPL-3.0-or-later

// Removes spikes one quad wide from the borders between regions of quads.
#pragma once

#include "prefilter/voxels/contour/dual_loops.h"
#include "prefilter/voxels/contour/feature_surface.h"
#include "prefilter/voxels/contour/sharp_vertices.h"
#include "prefilter/voxels/contour/surface_vertices.h"

namespace prefilter {

/// If a quad has another region at three of its sides, all four corners would lie on one edge, with
/// nothing between them. Assigns it to that region, and moves its vertex there.
void straighten_borders(const DualLoops& loops, const FeatureSurface& surface,
                        VertexSamples* samples, SurfaceVertices* vertices);

}  // namespace prefilter
