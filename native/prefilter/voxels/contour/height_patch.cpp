// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/voxels/contour/height_patch.h"

#include <cmath>

#include "prefilter/base/elementary.h"

namespace prefilter {
double HeightPatch::above(const Vector3& point, Vector3* gradient) const {
  const Vector3 offset = point - center;
  const int first = (axis + 1) % 3;
  const int second = (axis + 2) % 3;
  const double s = offset[first];
  const double t = offset[second];
  const double surface = height + slopes[0] * s + slopes[1] * t + twist * s * t +
                         curvatures[0] / 2.0 * (s * s - 1.0 / 12.0) +
                         curvatures[1] / 2.0 * (t * t - 1.0 / 12.0);
  if (gradient != nullptr) {
    (*gradient)[axis] = is_up ? 1.0 : -1.0;
    (*gradient)[first] = -(slopes[0] + curvatures[0] * s + twist * t);
    (*gradient)[second] = -(slopes[1] + curvatures[1] * t + twist * s);
  }
  return (is_up ? offset[axis] : -offset[axis]) - surface;
}

Vector3 HeightPatch::projected(Vector3 point, Vector3* gradient) const {
  for (int step = 0; step < 3; ++step) {
    const double over = above(point, gradient);
    point = point - (over / dot(*gradient, *gradient)) * *gradient;
  }
  return point;
}

Vector3 HeightPatch::foot() const {
  Vector3 foot = center;
  foot[axis] += is_up ? height : -height;
  return foot;
}

Vector3 HeightPatch::normal() const {
  Vector3 gradient;
  above(center, &gradient);
  return (1.0 / length(gradient)) * gradient;
}

bool fit_heights(const std::array<std::array<double, 3>, 3>& heights, HeightPatch* fitted,
                 double most_curved, double most_off) {
  HeightPatch& patch = *fitted;
  // Least-squares fit to nine heights.
  double sum = 0.0;
  double sum_first = 0.0;
  double sum_second = 0.0;
  patch.slopes = {};
  patch.twist = 0.0;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      const double h = heights[i][j];
      sum += h;
      if (i != 1) sum_first += h;
      if (j != 1) sum_second += h;
      patch.slopes[0] += (i - 1) * h / 6.0;
      patch.slopes[1] += (j - 1) * h / 6.0;
      patch.twist += (i - 1) * (j - 1) * h / 4.0;
    }
  }
  patch.curvatures = {sum_first - 2.0 / 3.0 * sum, sum_second - 2.0 / 3.0 * sum};
  patch.height = sum / 9.0 - (patch.curvatures[0] + patch.curvatures[1]) / 3.0;
  const double stretch = elementary::pow(
      1.0 + patch.slopes[0] * patch.slopes[0] + patch.slopes[1] * patch.slopes[1], 1.5);
  for (const double curvature : {patch.curvatures[0], patch.curvatures[1], patch.twist}) {
    if (std::abs(curvature) > most_curved * stretch) return false;
  }
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      const double s = i - 1;
      const double t = j - 1;
      const double expected = patch.height + patch.slopes[0] * s + patch.slopes[1] * t +
                              patch.twist * s * t + patch.curvatures[0] / 2.0 * s * s +
                              patch.curvatures[1] / 2.0 * t * t;
      if (std::abs(heights[i][j] - expected) > most_off) return false;
    }
  }
  return true;
}

}  // namespace prefilter
