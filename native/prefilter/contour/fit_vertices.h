// The interpolant "plane": vertices moved to the surface that leaves the cells around theirs.
#pragma once

#include "prefilter/contour/contour_options.h"
#include "prefilter/contour/surface_vertices.h"

namespace prefilter {

/// Moves vertices along their lines to where height_crossing finds the surface; where it finds
/// none they stay. Throws Error(kCancelled).
void fit_vertices(const ContourTree& tree, const RootFrame& frame, const Progress& progress,
                  int threads, SurfaceVertices* vertices);

}  // namespace prefilter
