// SPDX-License-Identifier: GPL-3.0-or-later

// Classifies the space in front of and behind triangles.
#pragma once

#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/base/run.h"
#include "prefilter/voxels/solid/reach.h"

namespace prefilter {

/// Shares of a triangle, by the labels in front and behind: the outside, or a region that the
/// outside does not reach.
struct TriangleSides {
  float outside_both = 0.0F;
  float outside_front = 0.0F;  // with a region behind
  float outside_back = 0.0F;   // with a region in front
  float inside_both = 0.0F;
  ReachGrid::Label region = ReachGrid::kSurface;  // a region on exactly one side
};

/// The shares of each triangle, by sampling; all 0 for triangles without area. Throws
/// Error(kCancelled).
std::vector<TriangleSides> sides_of_triangles(const MeshView<std::int32_t>& mesh,
                                              const ReachGrid& grid, const Run& run);

}  // namespace prefilter
