// SPDX-License-Identifier: GPL-3.0-or-later

// The one coefficient whose field has no compact support: the mean over the root.
#pragma once

#include <array>

#include "prefilter/wavelet/boundary_flux.h"
#include "prefilter/wavelet/cell_polygon.h"

namespace prefilter {

/// The mean of an indicator function over the root, the unit cube, from its boundary.
///
/// The printed c^(0,0,0) is the volume of the whole shape, and it is off by a hole's area times its
/// distance from the origin. Here the field is clamped instead: the flux of (p_a clamped to [0,
/// 1]), or of that less 1, along the axis a through the boundary in the column of the root. These
/// are six estimates, all the same for a closed surface. A hole harms those along which it is seen;
/// the median takes no notice of the worst of them.
class RootMean {
 public:
  /// All of the boundary within the root.
  void add_inside(const BoundaryFlux& flux) { inside_.add(flux); }
  /// A triangle that is not all within the root: its parts above and below it along the axes count.
  void add_outside(const CellPolygon& triangle);
  double median() const;

 private:
  BoundaryFlux inside_;
  Vector3 above_{};
  Vector3 below_{};
};

}  // namespace prefilter
