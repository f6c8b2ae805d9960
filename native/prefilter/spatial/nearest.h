// The points of a mesh nearest to others.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "prefilter/base/progress.h"

namespace prefilter {

/// A point of a triangle: the sum of its corners times these.
struct SurfacePoint {
  std::int64_t triangle = 0;
  std::array<double, 3> weights{};  // 0 and up; their sum is 1
  double distance = 0.0;            // to what was asked for
};

/// The nearest points of the triangles; of several, any, but always the same. Triangles of zero
/// area are segments or points. Throws Error for a mesh without triangles, an index that names no
/// vertex, values that are not finite or above 1e150, whose squares would overflow;
/// Error(kCancelled).
std::vector<SurfacePoint> nearest_points(std::span<const std::array<double, 3>> points,
                                         std::span<const std::array<double, 3>> positions,
                                         std::span<const std::array<std::int64_t, 3>> triangles,
                                         const Progress& progress, int threads);

}  // namespace prefilter
