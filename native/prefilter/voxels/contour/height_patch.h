// SPDX-License-Identifier: GPL-3.0-or-later

// A gently curved surface as heights over the side of a cell.
#pragma once

#include <array>

#include "prefilter/base/geometry.h"

namespace prefilter {

/// A quadratic along an axis. Lengths are cells of the root.
struct HeightPatch {
  Vector3 center{};  // of the cell
  int axis = 0;
  bool is_up = true;  // full cells are below
  double height = 0.0;
  std::array<double, 2> slopes{};  // along the axes behind `axis`, in order
  std::array<double, 2> curvatures{};
  double twist = 0.0;

  /// How far a point is above, along the axis, and its derivatives: the normal's direction.
  double above(const Vector3& point, Vector3* gradient) const;
  /// The point next to another that is on it, with the gradient there.
  Vector3 projected(Vector3 point, Vector3* gradient) const;
  Vector3 normal() const;
  Vector3 foot() const;
};

/// The least squares of the mean heights of 3 x 3 columns, which those of the quadratic are then
/// within `most_off` of; false where they are not, or where it is curved by more than
/// `most_curved`.
bool fit_heights(const std::array<std::array<double, 3>, 3>& heights, HeightPatch* patch,
                 double most_curved = 0.12, double most_off = 0.004);

}  // namespace prefilter
