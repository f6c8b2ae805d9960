// SPDX-License-Identifier: GPL-3.0-or-later

// Contours without folds.
#pragma once

#include <span>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/base/progress.h"
#include "prefilter/voxels/contour/contour_tree.h"
#include "prefilter/voxels/contour/looped_mesh.h"
#include "prefilter/voxels/contour/root_frame.h"
#include "prefilter/voxels/contour/sharp_vertices.h"
#include "prefilter/voxels/contour/surface_vertices.h"
#include "prefilter/voxels/remesh/faceted_mesh.h"

namespace prefilter {

/// Where vertices are halfway between the centers of their cells.
std::vector<Vector3> halfway(const ContourTree& tree, const RootFrame& frame,
                             const SurfaceVertices& vertices);

/// Where vertices go back to that are fitted now; `plain` is where they were before that.
Crossings crossings_of(const ContourTree& tree, const RootFrame& frame,
                       std::span<const Vector3> plain, const SurfaceVertices& vertices);

/// Triangulates loops that fold anew; where that does not do, puts their vertices back, but for
/// those that were sampled, or moves them toward those around them. `cell` has the sides of the
/// smallest cells.
void unfold(const VertexSamples& samples, const Vector3& cell, Crossings* crossings,
            LoopedMesh* looped);

/// The same for loops without edges where a contour's other loops have them. What that would have
/// intersect stays. Throws Error(kCancelled).
void unfold_plain_loops(const VertexSamples& samples, const Vector3& cell, Crossings* crossings,
                        const Progress& progress, int threads, FacetedMesh* mesh);

}  // namespace prefilter
