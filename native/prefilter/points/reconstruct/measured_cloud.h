// SPDX-License-Identifier: GPL-3.0-or-later

// A cloud without the points that stand for nothing, and where the others are.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "prefilter/base/progress.h"
#include "prefilter/points/point_source.h"
#include "prefilter/points/reconstruct.h"
#include "prefilter/points/reconstruct/carried_depth.h"
#include "prefilter/points/reconstruct/gather_samples.h"
#include "prefilter/points/reconstruct/phantom_points.h"
#include "prefilter/points/reconstruct/stray_points.h"

namespace prefilter {

/// Measures a source, and leaves out phantoms, huge coordinates and strays.
class MeasuredCloud {
 public:
  /// Looks for phantoms. Where `has_some`, some of the points are chosen. Throws
  /// Error(kCancelled).
  MeasuredCloud(PointSource* source, bool has_some, const Progress& progress, int threads);

  /// Whether so many normals have no direction that they should be estimated.
  bool lacks_normals() const;
  /// Leaves out strays, too. Throws Error where too few points are left; Error(kCancelled).
  void leave_out_rest(const Progress& progress, int threads);

  /// The points that count, and perhaps others.
  PointSource* points() { return points_; }
  const CloudExtent& extent() const { return extent_; }
  const std::vector<PhantomPlace>& phantoms() const { return phantoms_; }
  /// Of the phantoms.
  std::size_t phantom_points() const;
  ThinnedPoints& some() { return some_; }

 private:
  PointSource* points_;
  std::vector<PhantomPlace> phantoms_;
  std::optional<PointsWithout> real_;
  std::optional<PointsWithin> near_;
  ThinnedPoints some_;
  CloudExtent extent_;
};

}  // namespace prefilter
