// SPDX-License-Identifier: GPL-3.0-or-later

// The point of a mesh nearest to each of many points.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/base/progress.h"

namespace prefilter {

/// A point of a triangle: the sum of its corners times these.
struct SurfacePoint {
  std::int64_t triangle = 0;
  Vector3 weights{};      // 0 and up; their sum is 1
  double distance = 0.0;  // to what was asked for
};

/// A mesh made ready for searches: a tree of boxes over a copy of it.
class NearestPoints {
 public:
  /// Triangles of zero area are segments or points. Throws Error for a mesh without triangles, an
  /// index that names no vertex, positions that are not finite or above 1e150, whose squares would
  /// overflow; Error(kCancelled).
  NearestPoints(const InputMesh& mesh, const Progress& progress, int threads);

  /// The same, for searches on triangles of one label alone: one for each triangle. Throws Error
  /// where there are not as many.
  NearestPoints(const InputMesh& mesh, std::span<const std::int32_t> labels,
                const Progress& progress, int threads);
  ~NearestPoints();

  /// The points of the triangles nearest to these; of several triangles at the same distance, the
  /// one with the lowest index. A search takes longer the more triangles there are whose boxes are
  /// nearer than that: all of them for triangles in a stack, or around one vertex. The same for any
  /// number of threads. Throws Error for points as for positions above; Error(kCancelled).
  std::vector<SurfacePoint> find(std::span<const Vector3> points, const Progress& progress,
                                 int threads) const;

  /// Likewise, each point's on triangles with the label of the triangle `origins` has for it; the
  /// nearer that is, the faster. Throws Error for an index that names no triangle, and where there
  /// are not as many as points.
  std::vector<SurfacePoint> find_on(std::span<const Vector3> points,
                                    std::span<const std::int32_t> origins, const Progress& progress,
                                    int threads) const;

 private:
  class Tree;
  std::unique_ptr<const Tree> tree_;
};

/// The same in one step, for a mesh that is asked once.
std::vector<SurfacePoint> nearest_points(std::span<const Vector3> points, const InputMesh& mesh,
                                         const Progress& progress, int threads);

}  // namespace prefilter
