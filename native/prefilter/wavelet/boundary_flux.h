// SPDX-License-Identifier: GPL-3.0-or-later

// Boundary integrals of a cell, from which the Haar coefficients of the enclosed shape are
// computed: six numbers, which nest.
//
// A coefficient is, by the divergence theorem, the flux of a field F with divergence psi^e (section
// 3.2.3). On each octant the compactly supported F are linear in one coordinate. So the
// coefficients of a cell follow from the vector areas and first moments of the boundary in its
// octants, and the numbers of the parent cell from those of its octants. The surface is cut only
// once, along the finest cells; all coarser coefficients are sums.
//
// The F printed for wavelets along several axes integrate along x only. The mean over the wavelet's
// axes has the same compact support and is symmetric: c^e is the mean over the axes a in e of the
// flux of Psi(p_a) times the psi of e's other axes along a. This reduces the maximum error due to
// missing parts of the surface.
#pragma once

#include <array>

#include "prefilter/wavelet/cell_polygon.h"
#include "prefilter/wavelet/cell_tree.h"

namespace prefilter {

/// Integrals over the boundary within a cell, in coordinates of the unit cube.
struct BoundaryFlux {
  Vector3 area{};    // integral of the outward normal n
  Vector3 moment{};  // integral of p_x n_x, p_y n_y, p_z n_z

  void add(const BoundaryFlux& other) {
    for (int a = 0; a < 3; ++a) {
      area[a] += other.area[a];
      moment[a] += other.moment[a];
    }
  }
};

/// Flux of a boundary polygon, in coordinates of the unit cell with this low corner.
inline BoundaryFlux polygon_flux(const CellPolygon& polygon, const Vector3& cell) {
  const Vector3& origin = polygon.corners[0];
  Vector3 previous;
  for (int a = 0; a < 3; ++a) previous[a] = polygon.corners[1][a] - origin[a];
  Vector3 area{};
  Vector3 moment{};
  for (int i = 2; i < polygon.count; ++i) {
    Vector3 next;
    for (int a = 0; a < 3; ++a) next[a] = polygon.corners[i][a] - origin[a];
    const Vector3 normal = {previous[1] * next[2] - previous[2] * next[1],
                            previous[2] * next[0] - previous[0] * next[2],
                            previous[0] * next[1] - previous[1] * next[0]};
    for (int a = 0; a < 3; ++a) {
      area[a] += normal[a];
      moment[a] += normal[a] * (previous[a] + next[a]);
    }
    previous = next;
  }
  BoundaryFlux flux;
  for (int a = 0; a < 3; ++a) {
    flux.area[a] = area[a] / 2.0;
    flux.moment[a] = flux.area[a] * (origin[a] - cell[a]) + moment[a] / 6.0;
  }
  return flux;
}

/// Flux of a cell from the fluxes of its octants.
inline BoundaryFlux flux_of_octants(const std::array<BoundaryFlux, 8>& octants) {
  BoundaryFlux sum;
  for (int o = 0; o < 8; ++o) {
    for (int a = 0; a < 3; ++a) {
      const bool is_upper = ((o >> a) & 1) != 0;
      sum.area[a] += octants[o].area[a] / 4.0;
      sum.moment[a] += (octants[o].moment[a] + (is_upper ? octants[o].area[a] : 0.0)) / 8.0;
    }
  }
  return sum;
}

/// The seven coefficients [1] to [7] of a cell from the fluxes of its octants; [0] is 0.
inline OctantValues details_of_octants(const std::array<BoundaryFlux, 8>& octants) {
  std::array<double, 8> details{};
  for (int axis = 0; axis < 3; ++axis) {
    const int b = 1 << ((axis + 1) % 3);
    const int c = 1 << ((axis + 2) % 3);
    const int bit = 1 << axis;
    // Flux of Psi, which is p on the lower half and 1 - p on the upper half, in the four columns of
    // octants along the axis.
    const auto column = [&](int o) {
      const BoundaryFlux& low = octants[o];
      const BoundaryFlux& high = octants[o | bit];
      return (low.moment[axis] + (high.area[axis] - high.moment[axis])) / 8.0;
    };
    const double f0 = column(0);
    const double f1 = column(b);
    const double f2 = column(c);
    const double f3 = column(b | c);
    details[bit] += (f0 + f1) + (f2 + f3);
    details[bit | b] += ((f0 - f1) + (f2 - f3)) / 2.0;
    details[bit | c] += ((f0 + f1) - (f2 + f3)) / 2.0;
    details[bit | b | c] += ((f0 - f1) - (f2 - f3)) / 3.0;
  }
  OctantValues values{};
  for (int e = 1; e < 8; ++e) values[e] = static_cast<float>(details[e]);
  return values;
}

}  // namespace prefilter
