// SPDX-License-Identifier: GPL-3.0-or-later

// Normals of points without any, estimated from their neighbors and turned outward.
#pragma once

#include <span>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/base/names.h"
#include "prefilter/base/progress.h"

namespace prefilter {

inline constexpr int kLeastNeighbors = 3;
inline constexpr int kMostNeighbors = 1000;

/// Where normals point of which nobody knows from where they were seen.
enum class NormalSide {
  kOutward,  // as those of a closed surface, each connected part as a whole
  kUp,       // z is up: as those of a terrain, seen from above
};

inline constexpr Named<NormalSide> kNormalSides[] = {{"outward", NormalSide::kOutward},
                                                     {"up", NormalSide::kUp}};

/// The normal of each point: that of the plane which fits its `neighbours` nearest distinct
/// positions best, itself among them, near ones counting up to twice as much as far ones. Where
/// these lie along a line, as on a line of a scan, more of them are taken.
///
/// Normals point to the viewpoint: one for all points, or one for each. Without any, `side` says
/// where: outward, so that they agree with those around them, and those of each connected part
/// point outward as a whole, as far as can be told; or up, where walls, whose normals hardly do,
/// agree with those around them: see orient_normals.
///
/// Points that hold a value that is not finite, or above 1e150, get a zero normal, as do points of
/// which there are fewer than three distinct ones. Copies of a point count once. The same for any
/// number of threads. Throws Error for no points or more than 2^31 - 1, neighbours out of the range
/// above, another number of viewpoints than 0, 1 or that of the points, or one that is not finite;
/// Error(kCancelled).
std::vector<Vector3> estimate_normals(std::span<const Vector3> points, int neighbours,
                                      std::span<const Vector3> viewpoints, NormalSide side,
                                      const Progress& progress, int threads);

}  // namespace prefilter
