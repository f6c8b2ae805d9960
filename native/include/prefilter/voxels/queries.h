// SPDX-License-Identifier: GPL-3.0-or-later

// Queries of occupancy octrees: volume, values at points, the share of a box that is inside.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "prefilter/base/progress.h"
#include "prefilter/voxels/octree.h"

namespace prefilter {

/// The volume of the shape, in the cubed unit of length of the bounds.
double volume(const Octree& octree);

/// The share of a box that the shape fills, by the exact integral of the occupancies over it. The
/// sides of the box must be positive; throws Error otherwise.
double box_occupancy(const Octree& octree, const Box& box);

/// The occupancy of the leaf that holds a point; 0 outside of the bounds.
float value_at(const Octree& octree, const Vector3& point);

/// Those of several points.
std::vector<float> values_at(const Octree& octree, std::span<const Vector3> points, int threads);

/// Inside (1), outside (-1) or near the surface (0), as the occupancy of the leaf that holds a
/// point is within `tolerance` of 1, of 0, or of neither.
std::vector<std::int8_t> classify(const Octree& octree, std::span<const Vector3> points,
                                  double tolerance, int threads);

/// The occupancies of all n^3 cells of a depth, n = 2^depth, at [(x * n + y) * n + z]: means where
/// the tree is finer, and the leaf's where it is coarser. Throws Error(kOutOfMemory).
std::vector<float> dense_values(const Octree& octree, int depth, const Progress& progress,
                                int threads);

}  // namespace prefilter
