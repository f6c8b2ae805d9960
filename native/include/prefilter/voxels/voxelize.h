// SPDX-License-Identifier: GPL-3.0-or-later

// Meshes to occupancy octrees (chapter 3).
#pragma once

#include <optional>

#include "prefilter/base/geometry.h"
#include "prefilter/base/progress.h"
#include "prefilter/voxels/octree.h"

namespace prefilter {

struct VoxelizeOptions {
  int depth = 8;              // 1 to kMaxTreeDepth: 2^depth cells along an axis
  std::optional<Box> bounds;  // the root; none: a cube around the mesh
  double thickness = 0.0;     // in cells: what is thinner gets it; 0: stays as it is
  int threads = 0;            // 0: all processors
  Progress progress;
};

/// The occupancy of every cell: the exact volume of the mesh's inside in it over the cell's own.
///
/// The mesh may be anything: open, leaky, intersecting itself. Inside is where it winds around once
/// or more; values are clamped to [0, 1]. A hole disturbs the cells around it alone (see
/// analyze_triangles). Without `bounds` the root is cube_around the mesh's box.
///
/// With a `thickness` the solid is made as thick as this wherever it is thinner, by as little as it
/// takes, so that it holds together; rods get a quarter more. What faces the outside counts alone,
/// not where parts touch or overlap, nor edges of more than 45 degrees.
///
/// Throws Error for a depth out of range, a thickness that is negative or not finite, a mesh
/// without triangles or where all have zero area, an index that names no vertex, a position that is
/// not finite, and bounds of no volume; Error(kOutOfMemory) for a tree that would not fit into
/// memory; Error(kCancelled).
Octree voxelize(const InputMesh& mesh, const VoxelizeOptions& options);

/// The cube around a box that leaves a margin of two of the 2^depth cells along an axis on all
/// sides of the longest one, or an eighth of them where they are fewer than 16. Throws Error for a
/// depth out of range.
Box cube_around(const Box& box, int depth);

}  // namespace prefilter
