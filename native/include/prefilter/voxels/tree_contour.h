// SPDX-License-Identifier: GPL-3.0-or-later

// Occupancy octrees to closed meshes (chapter 5).
#pragma once

#include <cstdint>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/voxels/contour_options.h"
#include "prefilter/wavelet/cell_tree.h"

namespace prefilter {

/// The surface between leaves inside and outside: marching cubes on the dual grid of the leaves, of
/// any depths side by side. What is outside of the root is empty.
///
/// The mesh is closed and two-manifold, whatever the tree: each edge has two triangles, in opposite
/// directions, and the triangles around a vertex are one fan. Vertices are shared; the outside is
/// where triangles are counter-clockwise. Memory and time are proportional to the surface. The same
/// for any number of threads. Where interpolants are not defined (values outside of [0, 1], or an
/// iso-value other than 1/2) crossings are linear.
///
/// Throws Error for a root without volume, Error(kCancelled), and Error(kOutOfMemory) for more than
/// 2^31 vertices.
TriangleMesh contour_tree(const CellTree& cells, const Box& root, const ContourOptions& options);

/// The contour of occupancies, for any tree: where the surface passes through cells of several
/// sizes contour_tree may cross itself, so such a tree is refined first. At another iso-value than
/// 1/2 the same as contour_tree.
TriangleMesh contour_occupancies(const CellTree& cells, const Box& root,
                                 const ContourOptions& options);

/// A contour, and where its triangles come from.
struct TracedMesh {
  TriangleMesh mesh;
  // For each triangle one of the sources, numbered through all of them, that belongs to the same
  // source, group and smooth region.
  std::vector<std::int64_t> origins;
};

/// The same with origins, for kSharp with sources. Throws Error, too, where there are none.
TracedMesh contour_traced(const CellTree& cells, const Box& root, const ContourOptions& options);

}  // namespace prefilter
