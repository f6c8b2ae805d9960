// SPDX-License-Identifier: GPL-3.0-or-later

// Contours without folds.
#pragma once

#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/contour/contour_tree.h"
#include "prefilter/contour/looped_mesh.h"
#include "prefilter/contour/root_frame.h"
#include "prefilter/contour/sharp_vertices.h"
#include "prefilter/contour/surface_vertices.h"

namespace prefilter {

/// Where vertices are halfway between the centers of their cells.
std::vector<Vector3> halfway(const ContourTree& tree, const RootFrame& frame,
                             const SurfaceVertices& vertices);

/// Puts vertices of triangles that fold back, but for those that were sampled; where that does not
/// do, moves them toward those around them.
void unfold(const VertexSamples& samples, Crossings* crossings, LoopedMesh* looped);

}  // namespace prefilter
