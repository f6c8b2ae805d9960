// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/wavelet/root_mean.h"

#include <algorithm>
#include <limits>

namespace prefilter {
namespace {
constexpr double kInfinity = std::numeric_limits<double>::infinity();

double area_along(const CellPolygon& polygon, int axis) {
  return polygon.count == 0 ? 0.0 : polygon_flux(polygon, {0.0, 0.0, 0.0}).area[axis];
}
}  // namespace

void RootMean::add_outside(const CellPolygon& triangle) {
  for (int axis = 0; axis < 3; ++axis) {
    CellPolygon column = triangle;
    clip_to_slab((axis + 1) % 3, 0.0, 1.0, &column);
    if (column.count > 0) clip_to_slab((axis + 2) % 3, 0.0, 1.0, &column);
    if (column.count == 0) continue;
    CellPolygon below = column;
    clip_to_slab(axis, -kInfinity, 0.0, &below);
    below_[axis] += area_along(below, axis);
    clip_to_slab(axis, 1.0, kInfinity, &column);
    above_[axis] += area_along(column, axis);
  }
}

double RootMean::median() const {
  std::array<double, 6> estimates{};
  for (int a = 0; a < 3; ++a) {
    estimates[2 * a] = inside_.moment[a] + above_[a];
    estimates[2 * a + 1] = inside_.moment[a] - inside_.area[a] - below_[a];
  }
  std::sort(estimates.begin(), estimates.end());
  return (estimates[2] + estimates[3]) / 2.0;
}

}  // namespace prefilter
