// SPDX-License-Identifier: GPL-3.0-or-later

// Mean of a paint over each pixel of a row.
#pragma once

#include <optional>

#include "prefilter/shapes/paint.h"
#include "prefilter/shapes/raster/gradient_means.h"
#include "prefilter/shapes/raster/round_gradient.h"

namespace prefilter {

/// Exact for constant and linear paints. Other paints use slope and curvature where they are
/// smooth, otherwise GradientMeans, or nine points per pixel if they jump between stops that are
/// not fine. All means stay within the range of the values.
class PaintMeans {
 public:
  /// The paint must outlive this object, and be of another kind than kLinearStops.
  explicit PaintMeans(const Paint& paint);

  /// Writes the means over the pixels [begin, end) of a row to `out`, with interleaved channels.
  void find(int begin, int end, int row, double* out) const;

 private:
  ChannelValues mean_of_points(const Point2& center) const;

  const Paint& paint_;
  std::optional<RoundGradient> round_;
  std::optional<GradientMeans> gradient_;
};

}  // namespace prefilter
