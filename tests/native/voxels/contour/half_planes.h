// SPDX-License-Identifier: GPL-3.0-or-later

// Shares of cells covered by half-planes.
#pragma once

#include <algorithm>
#include <vector>

namespace prefilter::testing {

// Share of the unit cell with its low corner at (x, y) that lies below the line a x + b y = c, by
// the trapezoidal rule on the intervals where its height over the cell is linear.
inline double share_below(double x, double y, double a, double b, double c) {
  if (b == 0.0) return std::clamp((a > 0.0 ? c / a - x : x + 1.0 - c / a), 0.0, 1.0);
  std::vector<double> cuts = {x, x + 1.0};
  if (a != 0.0) {
    for (const double level : {y, y + 1.0}) {
      const double at = (c - b * level) / a;
      if (at > x && at < x + 1.0) cuts.push_back(at);
    }
  }
  std::sort(cuts.begin(), cuts.end());
  const auto height = [&](double at) {
    const double line = (c - a * at) / b;
    const double below = std::clamp(line - y, 0.0, 1.0);
    return b > 0.0 ? below : 1.0 - below;
  };
  double sum = 0.0;
  for (std::size_t i = 1; i < cuts.size(); ++i) {
    sum += (cuts[i] - cuts[i - 1]) * (height(cuts[i]) + height(cuts[i - 1])) / 2.0;
  }
  return sum;
}

}  // namespace prefilter::testing
