// SPDX-License-Identifier: GPL-3.0-or-later

// A cloud without phantoms and far outliers, and its extent.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "prefilter/base/run.h"
#include "prefilter/points/point_source.h"
#include "prefilter/points/reconstruct.h"
#include "prefilter/points/reconstruct/automatic_depth.h"
#include "prefilter/points/reconstruct/far_outliers.h"
#include "prefilter/points/reconstruct/gather_samples.h"
#include "prefilter/points/reconstruct/phantom_points.h"

namespace prefilter {

/// Measures a source, and excludes phantoms, huge coordinates and far outliers.
class MeasuredCloud {
 public:
  /// Measures the cloud and searches it for phantoms. Where `is_thinned`, a subset of the points is
  /// collected as well. Throws Error(kCancelled).
  MeasuredCloud(PointSource* source, bool collects_thinned, const Run& run);

  /// Whether so many normals lack a direction that all should be estimated.
  bool lacks_normals() const;
  /// Excludes far outliers. Throws Error where too few points remain; Error(kCancelled).
  void exclude_outliers(const Run& run);

  /// The cloud without excluded points, which are left out or have weight 0.
  PointSource* points() { return points_; }
  const CloudExtent& extent() const { return extent_; }
  const std::vector<PhantomPlace>& phantoms() const { return phantoms_; }
  /// Number of points at phantom positions.
  std::size_t phantom_points() const;
  ThinnedPoints& thinned() { return thinned_; }

 private:
  PointSource* points_;
  std::vector<PhantomPlace> phantoms_;
  std::optional<PointsWithout> real_;
  std::optional<PointsWithin> near_;
  ThinnedPoints thinned_;
  CloudExtent extent_;
};

}  // namespace prefilter
