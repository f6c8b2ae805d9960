// SPDX-License-Identifier: GPL-3.0-or-later

// The mean over the root, the only coefficient whose field has no compact support.
#pragma once

#include <array>

#include "prefilter/wavelet/boundary_flux.h"
#include "prefilter/wavelet/cell_polygon.h"

namespace prefilter {

/// Computes the mean of an indicator function over the root, the unit cube, from its boundary.
///
/// The printed c^(0,0,0) is the volume of the whole shape. Its error for a hole is the hole's area
/// times its distance from the origin. Here the field is clamped instead: the flux of p_a clamped
/// to [0, 1], or of that minus 1, along axis a through the boundary in the root's column. These are
/// six estimates, which agree for a closed surface. A hole only affects the directions in which it
/// is visible; the median ignores the worst estimates.
class RootMean {
 public:
  /// Adds the boundary inside the root.
  void add_inside(const BoundaryFlux& flux) { inside_.add(flux); }
  /// Adds a triangle not entirely inside the root; its parts above and below the root along the
  /// axes count.
  void add_outside(const CellPolygon& triangle);
  double median() const;

 private:
  BoundaryFlux inside_;
  Vector3 above_{};
  Vector3 below_{};
};

}  // namespace prefilter
