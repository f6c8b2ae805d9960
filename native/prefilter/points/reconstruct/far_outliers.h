// SPDX-License-Identifier: GPL-3.0-or-later

// Finds points far from all others, such as zeros among geographic coordinates, or a bird.
#pragma once

#include <optional>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/base/run.h"
#include "prefilter/points/point_source.h"
#include "prefilter/points/reconstruct/gather_samples.h"

namespace prefilter {

/// Removes far outliers from a cloud's extent: up to one in 100 000 points (or one in 1000, but at
/// most 3) whose distance from the mean is about twice that of all others or more. Reads the source
/// again only if there may be any, once per iteration.
void exclude_far_outliers(PointSource* source, const Run& run, CloudExtent* extent);

/// Whether there may be far outliers, which only another pass over all points can confirm.
bool may_have_far_outliers(const CloudExtent& extent);

/// A source in which points outside a box get weight 0.
class PointsWithin final : public ChangedPoints {
 public:
  PointsWithin(PointSource* source, const Box& box) : ChangedPoints(source), box_(box) {}

  bool read(std::size_t most, PointBatch* batch) override;

 private:
  Box box_;
};

}  // namespace prefilter
