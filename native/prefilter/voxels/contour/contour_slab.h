// SPDX-License-Identifier: GPL-3.0-or-later

// Contours octrees larger than memory, height by height.
#pragma once

#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/voxels/contour/height_range.h"
#include "prefilter/voxels/contour/surface_vertices.h"
#include "prefilter/voxels/contour_options.h"
#include "prefilter/wavelet/cell_tree.h"

namespace prefilter {

/// The part of a contour made of the dual cells at some heights. Parts at adjacent heights share
/// vertices, and together form the whole contour.
struct ContourSlab {
  TriangleMesh mesh;  // the root is the unit cube; all vertices are used
  // Places of the first vertices, which lie between two leaves. The other vertices belong to this
  // part alone.
  std::vector<VertexPlace> places;
};

/// Contours a tree that has levels, and is complete where dual cells at these heights have corners.
/// Runs on the calling thread.
ContourSlab contour_slab(const CellTree& cells, float isovalue, Interpolant interpolant,
                         const HeightRange& heights);

}  // namespace prefilter
