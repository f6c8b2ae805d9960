// SPDX-License-Identifier: GPL-3.0-or-later

// What is in front of triangles, and behind them.
#pragma once

#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/base/progress.h"
#include "prefilter/voxels/solid/reach.h"

namespace prefilter {

/// Shares of a triangle, by what is in front of it and behind it: the outside, or a region that the
/// outside does not reach.
struct TriangleSides {
  float outside_both = 0.0F;
  float outside_front = 0.0F;  // and a region behind
  float outside_back = 0.0F;   // and a region in front
  float inside_both = 0.0F;
  ReachGrid::Label region = ReachGrid::kMet;  // one that it has on one side alone
};

/// Those of each triangle, by samples; all 0 for one without an area. Throws Error(kCancelled).
std::vector<TriangleSides> sides_of_triangles(const MeshView<std::int32_t>& mesh,
                                              const ReachGrid& grid, const Progress& progress,
                                              int threads);

}  // namespace prefilter
