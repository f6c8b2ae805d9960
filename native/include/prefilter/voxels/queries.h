// SPDX-License-Identifier: GPL-3.0-or-later

// Queries of occupancy octrees: volume, values at points, occupied share of a box.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "prefilter/base/run.h"
#include "prefilter/voxels/octree.h"

namespace prefilter {

/// Volume of the shape, in cubed units of the bounds.
double volume(const Octree& octree);

/// Share of a box that the shape fills, by exact integration of the occupancies. Throws Error for a
/// box without volume.
double box_occupancy(const Octree& octree, const Box& box);

/// Occupancy of the leaf that contains a point; 0 outside the bounds.
float value_at(const Octree& octree, const Vector3& point);

/// Occupancies of the leaves that contain the points.
std::vector<float> values_at(const Octree& octree, std::span<const Vector3> points, int threads);

/// Classifies points as inside (1), outside (-1) or near the surface (0): as the occupancy of the
/// leaf is within `tolerance` of 1, of 0, or of neither.
std::vector<std::int8_t> classify(const Octree& octree, std::span<const Vector3> points,
                                  double tolerance, int threads);

/// Occupancies of all n^3 cells of a depth, n = 2^depth, at index [(x * n + y) * n + z]: means
/// where the tree is finer, and the leaf's value where it is coarser. Throws Error(kOutOfMemory).
std::vector<float> dense_values(const Octree& octree, int depth, const Run& run);

}  // namespace prefilter
