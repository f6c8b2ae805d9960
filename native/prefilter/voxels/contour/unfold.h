// SPDX-License-Identifier: GPL-3.0-or-later

// Removes folds of contours.
#pragma once

#include <span>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/base/run.h"
#include "prefilter/voxels/contour/contour_tree.h"
#include "prefilter/voxels/contour/looped_mesh.h"
#include "prefilter/voxels/contour/root_frame.h"
#include "prefilter/voxels/contour/sharp_vertices.h"
#include "prefilter/voxels/contour/surface_vertices.h"
#include "prefilter/voxels/remesh/faceted_mesh.h"

namespace prefilter {

/// The midpoints between the centers of each vertex's cells.
std::vector<Vector3> halfway(const ContourTree& tree, const RootFrame& frame,
                             const SurfaceVertices& vertices);

/// Fallback positions for fitted vertices; `plain` holds the positions before fitting.
Crossings crossings_of(const ContourTree& tree, const RootFrame& frame,
                       std::span<const Vector3> plain, const SurfaceVertices& vertices);

/// Retriangulates folded loops. If that fails, moves their vertices, except sampled ones, back, or
/// toward their neighbors. `cell` holds the sides of the smallest cells.
void unfold(const VertexSamples& samples, const Vector3& cell, Crossings* crossings,
            LoopedMesh* looped);

/// The same for loops without edges when other loops of the contour have edges. Changes that would
/// cause intersections are omitted. Throws Error(kCancelled).
void unfold_plain_loops(const VertexSamples& samples, const Vector3& cell, Crossings* crossings,
                        const Run& run, FacetedMesh* mesh);

}  // namespace prefilter
