// SPDX-License-Identifier: GPL-3.0-or-later

// Borders between regions of quads, without spikes one quad wide.
#pragma once

#include "prefilter/voxels/contour/dual_loops.h"
#include "prefilter/voxels/contour/feature_surface.h"
#include "prefilter/voxels/contour/sharp_vertices.h"
#include "prefilter/voxels/contour/surface_vertices.h"

namespace prefilter {

/// Of a quad with another region beside three of its sides, all four corners would be on one edge,
/// and nothing between them: it is given to that region, and its vertex moved there.
void straighten_borders(const DualLoops& loops, const FeatureSurface& surface,
                        VertexSamples* samples, SurfaceVertices* vertices);

}  // namespace prefilter
