// SPDX-License-Identifier: GPL-3.0-or-later

// Checks on a subset of a cloud whether given normals agree with those of neighboring points.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/base/run.h"
#include "prefilter/points/point_source.h"
#include "prefilter/points/reconstruct/automatic_depth.h"

namespace prefilter {

/// Collects the neighbors of some probe points while the cloud is read.
class NormalProbe {
 public:
  /// A point near one of the probes.
  struct NearPoint {
    std::uint32_t probed = 0;
    double squared = 0.0;  // squared distance from the probe, in units of the box's longest side
    Vector3 position{};
    std::array<float, 3> normal{};
  };

  /// `thinned` is a subset of the cloud's positions; it bounds how far each probe's neighbors are.
  /// A box without extent yields no probes. Throws Error(kCancelled).
  NormalProbe(const ThinnedPoints& thinned, const Box& box, const Run& run);

  /// The points of a batch that may be among a probe's nearest.
  std::vector<NearPoint> find_near(const PointBatch& batch) const;
  /// Adds the result of find_near for a batch; call in order of the batches.
  void add(const std::vector<NearPoint>& near);

  /// Share of neighbors, from 0 to 1, whose normals are opposed to the probe's although they are
  /// not on the other side of a thin part; 0 where too few points were found. It is about 1/2 for
  /// normals of random sign.
  double contradiction() const;

 private:
  struct Probed {
    Vector3 position{};  // scaled
    double squared = 0.0;
    std::vector<NearPoint> nearest;  // sorted by distance
  };

  Vector3 scaled(const Vector3& position) const;
  std::size_t cell_of(const Vector3& scaled) const;

  Box box_;
  double longest_;
  std::vector<Probed> probed_;
  std::vector<std::vector<std::uint32_t>> cells_;  // indices of the probes near each grid cell
};

}  // namespace prefilter
