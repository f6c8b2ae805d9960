// SPDX-License-Identifier: GPL-3.0-or-later

// The mean of a paint over each pixel of a row.
#pragma once

#include <optional>

#include "prefilter/shapes/paint.h"
#include "prefilter/shapes/raster/gradient_means.h"
#include "prefilter/shapes/raster/round_gradient.h"

namespace prefilter {

/// Exact for constant and linear paints. Others are told by slope and curvature where they are
/// smooth, and else by GradientMeans, or by nine points of a pixel where they jump between stops
/// that are not fine, so that means are within the range of the values.
class PaintMeans {
 public:
  /// The paint, of any kind but kLinearStops, must outlive it.
  explicit PaintMeans(const Paint& paint);

  /// Writes the means over the pixels [begin, end) of a row to `out`, channel by channel.
  void find(int begin, int end, int row, double* out) const;

 private:
  ChannelValues mean_of_points(const Point2& center) const;

  const Paint& paint_;
  std::optional<RoundGradient> round_;
  std::optional<GradientMeans> gradient_;
};

}  // namespace prefilter
