// SPDX-License-Identifier: GPL-3.0-or-later

// Edges and corners in a contour: extended marching cubes (Kobbelt, Botsch, Schwanecke and Seidel
// 2001), on loops of any dual grid.
#pragma once

#include <vector>

#include "prefilter/base/progress.h"
#include "prefilter/voxels/contour/feature_surface.h"
#include "prefilter/voxels/contour/looped_mesh.h"
#include "prefilter/voxels/contour/sharp_vertices.h"
#include "prefilter/voxels/remesh/faceted_mesh.h"

namespace prefilter {

/// Puts a vertex into each sharp loop, where the surfaces of its vertices meet, and joins those of
/// loops that are side by side: the mesh edges between them are flipped. So each triangle is on one
/// region, whose label it has; -1 is far from edges. Where that would have triangles intersect,
/// loops stay as they are: the result is closed, two-manifold and free of intersections where it is
/// without its edges. `crossings` are the positions of the vertices between cells, the first ones,
/// before they were sampled. Throws Error(kCancelled).
FacetedMesh sharpen(LoopedMesh looped, const Crossings& crossings, const FeatureSurface& surface,
                    const VertexSamples& samples, const Progress& progress, int threads);

}  // namespace prefilter
