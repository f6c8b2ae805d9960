// SPDX-License-Identifier: GPL-3.0-or-later

// Converts meshes to occupancy octrees (chapter 3).
#pragma once

#include <optional>

#include "prefilter/base/geometry.h"
#include "prefilter/base/run.h"
#include "prefilter/voxels/octree.h"

namespace prefilter {

struct VoxelizeOptions {
  int depth = 8;              // 1 to kMaxTreeDepth: 2^depth cells along an axis
  std::optional<Box> bounds;  // bounds of the root; none: a cube around the mesh
  double thickness = 0.0;     // in cells: minimum thickness; 0: no thickening
  Run run;
};

/// Computes the occupancy of every cell: the exact volume of the mesh's inside in it, relative to
/// the cell's.
///
/// The mesh may be open, leaky or self-intersecting. Points with a winding number of 1 or more are
/// inside; values are clamped to [0, 1]. A hole affects only the cells around it (see
/// analyze_triangles). Without `bounds` the root is cube_around the mesh's box.
///
/// With a `thickness`, thinner parts of the solid are thickened to it by the minimum amount, so
/// that they stay connected; rods get a quarter more. Only faces toward the outside count: neither
/// places where parts touch or overlap, nor edges of more than 45 degrees.
///
/// Throws Error for a depth out of range, a thickness that is negative or not finite, a mesh
/// without triangles or of zero area, an invalid vertex index, a position that is not finite, and
/// bounds without volume; Error(kOutOfMemory) for a tree that would not fit into memory;
/// Error(kCancelled).
Octree voxelize(const InputMesh& mesh, const VoxelizeOptions& options);

/// The cube around a box with a margin, on all sides of the longest axis, of two of the 2^depth
/// cells per axis, or of an eighth of them if there are fewer than 16. Throws Error for a depth out
/// of range.
Box cube_around(const Box& box, int depth);

}  // namespace prefilter
