// SPDX-License-Identifier: GPL-3.0-or-later

// Contours of octrees larger than memory, height by height.
#pragma once

#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/voxels/contour/height_range.h"
#include "prefilter/voxels/contour/surface_vertices.h"
#include "prefilter/voxels/contour_options.h"
#include "prefilter/wavelet/cell_tree.h"

namespace prefilter {

/// The part of a contour that is made of the dual cells at some heights. Parts at heights that
/// follow each other have vertices in common, and together are the whole.
struct ContourSlab {
  TriangleMesh mesh;  // in a root that is the unit cube; all vertices have triangles
  // Of the first vertices, which lie between two leaves. The others are of this part alone.
  std::vector<VertexPlace> places;
};

/// Of a tree that has levels, and is complete where dual cells at these heights have corners. Runs
/// on the calling thread.
ContourSlab contour_slab(const CellTree& cells, float isovalue, Interpolant interpolant,
                         const HeightRange& heights);

}  // namespace prefilter
