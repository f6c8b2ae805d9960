// SPDX-License-Identifier: GPL-3.0-or-later

// Points that are far from all others: a scanner's zeros in coordinates of a country, a bird.
#pragma once

#include <optional>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/base/progress.h"
#include "prefilter/points/point_source.h"
#include "prefilter/points/reconstruct/gather_samples.h"

namespace prefilter {

/// Takes strays out of what was found of a cloud: the one in 100 000 points (one in 1000, where
/// that are up to 3) that is about twice as far from the mean of all as the others are, or farther.
/// Reads the source again where there may be such, once for each distance that they have.
void leave_out_strays(PointSource* source, const Progress& progress, int threads,
                      CloudExtent* extent);

/// Whether there may be strays; that takes a look at all points again.
bool may_have_strays(const CloudExtent& extent);

/// A source whose points outside of a box have no weight.
class PointsWithin final : public ChangedPoints {
 public:
  PointsWithin(PointSource* source, const Box& box) : ChangedPoints(source), box_(box) {}

  bool read(std::size_t most, PointBatch* batch) override;

 private:
  Box box_;
};

}  // namespace prefilter
