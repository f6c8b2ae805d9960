// SPDX-License-Identifier: GPL-3.0-or-later

// Adds edges and corners to a contour by extended marching cubes (L. Kobbelt, M. Botsch, U.
// Schwanecke, H.-P. Seidel, Feature sensitive surface extraction from volume data, 2001), on loops
// of any dual grid.
#pragma once

#include <vector>

#include "prefilter/base/run.h"
#include "prefilter/voxels/contour/feature_surface.h"
#include "prefilter/voxels/contour/looped_mesh.h"
#include "prefilter/voxels/contour/sharp_vertices.h"
#include "prefilter/voxels/remesh/faceted_mesh.h"

namespace prefilter {

/// Adds a vertex to each sharp loop, at the intersection of the surfaces of its vertices, and flips
/// the mesh edges between adjacent loops to join their vertices. As a result each triangle lies on
/// one region, whose label it gets; -1 far from edges. Loops for which triangles would intersect
/// stay unchanged: the result is closed, two-manifold and free of intersections if the contour
/// without edges is. `crossings` holds the positions of the vertices between cells, which come
/// first, before sampling. Throws Error(kCancelled).
FacetedMesh sharpen(LoopedMesh looped, const Crossings& crossings, const FeatureSurface& surface,
                    const VertexSamples& samples, const Run& run);

}  // namespace prefilter
