// SPDX-License-Identifier: GPL-3.0-or-later

// Finds the nearest point on a mesh for many points.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/base/run.h"

namespace prefilter {

/// A point of a triangle: the sum of its corners times `weights`.
struct SurfacePoint {
  std::int64_t triangle = 0;
  Vector3 weights{};      // nonnegative, with sum 1
  double distance = 0.0;  // from the query point
};

/// A copy of a mesh with a bounding box tree for searches.
class NearestPoints {
 public:
  /// Triangles of zero area act as segments or points. Throws Error for a mesh without triangles,
  /// an index out of range, and for positions that are not finite or above 1e150, whose squares
  /// would overflow; Error(kCancelled).
  NearestPoints(const InputMesh& mesh, const Run& run);

  /// The same with a label per triangle, for searches restricted to one label. Throws Error unless
  /// there are as many labels as triangles.
  NearestPoints(const InputMesh& mesh, std::span<const std::int32_t> labels, const Run& run);
  ~NearestPoints();

  /// Finds the nearest point for each query; at equal distances, on the triangle with the lowest
  /// index. Searches are slower the more triangles have boxes closer than the nearest point, as in
  /// a stack, or around a common vertex. The result is the same for any number of threads. Throws
  /// Error for query points like for positions above; Error(kCancelled).
  std::vector<SurfacePoint> find(std::span<const Vector3> points, const Run& run) const;

  /// The same, but each point only considers triangles with the label of its triangle in `origins`;
  /// nearby origins make it faster. Throws Error for an index out of range, or unless there is one
  /// per point.
  std::vector<SurfacePoint> find_on(std::span<const Vector3> points,
                                    std::span<const std::int32_t> origins, const Run& run) const;

 private:
  class Tree;
  std::unique_ptr<const Tree> tree_;
};

/// The same in one step, for a single search.
std::vector<SurfacePoint> nearest_points(std::span<const Vector3> points, const InputMesh& mesh,
                                         const Run& run);

}  // namespace prefilter
