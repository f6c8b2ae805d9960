// SPDX-License-Identifier: GPL-3.0-or-later

// A subset of a cloud for statistics.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "prefilter/base/geometry.h"

namespace prefilter {

/// Distinct finite positions in sorted order, from every n-th point so that there are at most
/// `most`.
inline std::vector<Vector3> sample_positions(std::span<const Vector3> points, std::size_t most) {
  std::vector<Vector3> result;
  const std::size_t step = (points.size() + most - 1) / most;
  for (std::size_t i = 0; i < points.size(); i += std::max<std::size_t>(step, 1)) {
    const Vector3& p = points[i];
    if (std::abs(p[0]) + std::abs(p[1]) + std::abs(p[2]) <= kLargestCoordinate) result.push_back(p);
  }
  // Copies of a point add no information about the shape.
  std::sort(result.begin(), result.end());
  result.erase(std::unique(result.begin(), result.end()), result.end());
  return result;
}

}  // namespace prefilter
