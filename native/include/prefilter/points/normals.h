// SPDX-License-Identifier: GPL-3.0-or-later

// Estimates normals from neighboring points, and orients them.
#pragma once

#include <span>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/base/names.h"
#include "prefilter/base/run.h"

namespace prefilter {

inline constexpr int kMinNormalNeighbors = 3;
inline constexpr int kMaxNormalNeighbors = 1000;

/// Orientation of normals if no viewpoint is known.
enum class NormalSide {
  kOutward,  // as for closed surfaces, for each connected part on the whole
  kUp,       // toward +z, as for terrain seen from above
};

inline constexpr Named<NormalSide> kNormalSides[] = {{"outward", NormalSide::kOutward},
                                                     {"up", NormalSide::kUp}};

/// Estimates the normal of each point from the plane that best fits its `neighbours` nearest
/// distinct positions, itself included, with weights from 1 down to 1/2 for the farthest. If these
/// are collinear, as on a scan line, more neighbors are used.
///
/// Normals point to the viewpoint: one for all points, or one for each. Without viewpoints, `side`
/// decides: outward, so that neighbors agree and each connected part points outward on the whole,
/// as far as can be determined; or up, where normals of walls, which are almost horizontal, agree
/// with their neighbors (see orient_normals).
///
/// Points with a value that is not finite, or above 1e150, get a zero normal, as do all points if
/// fewer than three are distinct. Copies of a point count once. The result is the same for any
/// number of threads. Throws Error for no points or more than 2^31 - 1, neighbours out of range, a
/// number of viewpoints other than 0, 1 or the number of points, or a viewpoint that is not finite;
/// Error(kCancelled).
std::vector<Vector3> estimate_normals(std::span<const Vector3> points, int neighbours,
                                      std::span<const Vector3> viewpoints, NormalSide side,
                                      const Run& run);

}  // namespace prefilter
