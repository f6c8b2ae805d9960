// SPDX-License-Identifier: GPL-3.0-or-later

// Quadrature over a cell, derived from the moments of its measure.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "prefilter/geometry/moments/cell_moments.h"

namespace prefilter {

/// Four points at one standard deviation from the mean along each axis, with nonnegative weights
/// that depend on the correlation. They reproduce the moments 1, x, y, x^2, y^2 and xy of the
/// measure; for a uniform measure they are the Gauss rule of degree 3.
struct FourPointRule {
  double mean_x = 0.0;
  double mean_y = 0.0;
  double deviation_x = 0.0;
  double deviation_y = 0.0;
  double same = 0.0;      // weight of points 0 and 3, on the same side along both axes
  double opposite = 0.0;  // weight of points 1 and 2

  explicit FourPointRule(const WeightMoments& moments) {
    const double mass = moments[0];
    mean_x = moments[1] / mass;
    mean_y = moments[3] / mass;
    deviation_x = deviation(moments[2] / mass - mean_x * mean_x);
    deviation_y = deviation(moments[6] / mass - mean_y * mean_y);
    double correlation = 0.0;
    if (deviation_x > 0.0 && deviation_y > 0.0) {
      const double covariance = moments[4] / mass - mean_x * mean_y;
      correlation = std::clamp(covariance / (deviation_x * deviation_y), -1.0, 1.0);
    }
    same = 0.25 * mass * (1.0 + correlation);
    opposite = 0.25 * mass * (1.0 - correlation);
  }

  /// Point k of 0 to 3: low and high along x, then the same higher in y.
  double x(int k) const { return k % 2 == 0 ? mean_x - deviation_x : mean_x + deviation_x; }
  double y(int k) const { return k < 2 ? mean_y - deviation_y : mean_y + deviation_y; }
  double weight(int k) const { return k == 0 || k == 3 ? same : opposite; }

  /// Values at the points for an image: their sums times 1, x, y and xy are its moments.
  std::array<double, 4> integrals(const ImageMoments& image) const {
    const double along_x = deviation_x > 0.0 ? 1.0 / deviation_x : 0.0;
    const double along_y = deviation_y > 0.0 ? 1.0 / deviation_y : 0.0;
    const double level = image[0];
    const double slope_x = along_x * (image[1] - mean_x * image[0]);
    const double slope_y = along_y * (image[2] - mean_y * image[0]);
    const double twist =
        along_x * along_y *
        (image[3] - mean_x * image[2] - mean_y * image[1] + mean_x * mean_y * level);
    return {0.25 * (level - slope_x - slope_y + twist), 0.25 * (level + slope_x - slope_y - twist),
            0.25 * (level - slope_x + slope_y - twist), 0.25 * (level + slope_x + slope_y + twist)};
  }

 private:
  // Variances of the size of rounding errors count as 0.
  static double deviation(double variance) { return variance > 1e-10 ? std::sqrt(variance) : 0.0; }
};

}  // namespace prefilter
