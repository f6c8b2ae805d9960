// SPDX-License-Identifier: GPL-3.0-or-later

// A gently curved surface, as heights over the side of a cell.
#pragma once

#include <array>

#include "prefilter/base/geometry.h"

namespace prefilter {

/// A quadratic height field along an axis. Lengths are in cells of the root.
struct HeightPatch {
  Vector3 center{};  // of the cell
  int axis = 0;
  bool is_up = true;  // whether the full cells are below
  double height = 0.0;
  std::array<double, 2> slopes{};  // along the axes after `axis`, cyclically
  std::array<double, 2> curvatures{};
  double twist = 0.0;

  /// The height of a point above the patch along the axis, and its gradient, the normal's
  /// direction.
  double above(const Vector3& point, Vector3* gradient) const;
  /// The nearest point on the patch, with the gradient there.
  Vector3 projected(Vector3 point, Vector3* gradient) const;
  Vector3 normal() const;
  Vector3 foot() const;
};

/// Fits a quadratic to the mean heights of 3 x 3 columns by least squares. Returns false if its
/// column means deviate by more than `most_off`, or its curvature exceeds `most_curved`.
bool fit_heights(const std::array<std::array<double, 3>, 3>& heights, HeightPatch* patch,
                 double most_curved = 0.12, double most_off = 0.004);

}  // namespace prefilter
