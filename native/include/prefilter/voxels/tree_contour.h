// SPDX-License-Identifier: GPL-3.0-or-later

// Contours occupancy octrees as closed meshes (chapter 5).
#pragma once

#include <cstdint>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/voxels/contour_options.h"
#include "prefilter/wavelet/cell_tree.h"

namespace prefilter {

/// The surface between leaves inside and outside, by marching cubes on the dual grid of the leaves,
/// which may be of any depths. The outside of the root is empty.
///
/// For any tree the mesh is closed and two-manifold: each edge has two triangles, in opposite
/// directions, and the triangles around a vertex form one fan. Vertices are shared; triangles are
/// counterclockwise seen from outside. Memory and time are proportional to the surface. The result
/// does not depend on the number of threads. Where interpolants are undefined (values outside [0,
/// 1], or an iso-value other than 1/2) crossings are linear.
///
/// Throws Error for a root without volume, Error(kCancelled), and Error(kOutOfMemory) for more than
/// 2^31 vertices.
TriangleMesh contour_tree(const CellTree& cells, const Box& root, const ContourOptions& options);

/// Contours occupancies of any tree. Where the surface passes through cells of several sizes,
/// contour_tree may self-intersect, so such trees are refined first. At iso-values other than 1/2
/// it is the same as contour_tree.
TriangleMesh contour_occupancies(const CellTree& cells, const Box& root,
                                 const ContourOptions& options);

/// A contour, and the origins of its triangles.
struct TracedMesh {
  TriangleMesh mesh;
  // For each triangle a source triangle, numbered across all sources, of the same source, group and
  // smooth region.
  std::vector<std::int64_t> origins;
};

/// Like contour_occupancies, with origins; requires kSharp and sources, and throws Error without
/// them.
TracedMesh contour_traced(const CellTree& cells, const Box& root, const ContourOptions& options);

}  // namespace prefilter
