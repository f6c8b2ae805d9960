// SPDX-License-Identifier: GPL-3.0-or-later

// Whether given normals agree with those of the points around them, from some points of a cloud.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/base/progress.h"
#include "prefilter/points/point_source.h"
#include "prefilter/points/reconstruct/carried_depth.h"

namespace prefilter {

/// Collects the points nearest to some points of a cloud while all are read.
class NormalProbe {
 public:
  /// A point near the probed position of a number.
  struct NearPoint {
    std::uint32_t probed = 0;
    double squared = 0.0;  // distance from it, where the longest side of the box is 1
    Vector3 position{};
    std::array<float, 3> normal{};
  };

  /// `some` of the positions of a cloud in a box, which bound how far the nearest points are. A box
  /// without an extent leaves nothing to probe. Throws Error(kCancelled).
  NormalProbe(const ThinnedPoints& some, const Box& box, const Progress& progress, int threads);

  /// The points of a batch that may be among the nearest ones.
  std::vector<NearPoint> look_at(const PointBatch& batch) const;
  /// Adds what `look_at` returned, one batch after the other.
  void add(const std::vector<NearPoint>& near);

  /// The share of neighbors whose normals are opposed to that of the point, and which are not on
  /// the other side of a thin part, from 0 to 1; 0 where too few points were found. About 1/2 where
  /// each normal is reversed by chance.
  double contradiction() const;

 private:
  struct Probed {
    Vector3 position{};  // scaled
    double squared = 0.0;
    std::vector<NearPoint> nearest;  // sorted
  };

  Vector3 scaled(const Vector3& position) const;
  std::size_t cell_of(const Vector3& scaled) const;

  Box box_;
  double longest_;
  std::vector<Probed> probed_;
  std::vector<std::vector<std::uint32_t>> cells_;  // which probed positions are near each
};

}  // namespace prefilter
