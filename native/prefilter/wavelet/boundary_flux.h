// SPDX-License-Identifier: GPL-3.0-or-later

// What a cell has to know of the pieces of a boundary in it, to give the Haar coefficients of the
// shape that it bounds: six numbers, which nest.
//
// By the divergence theorem a coefficient is the flux of a field F with divergence psi^e (section
// 3.2.3). On each octant the F of compact support are linear in one coordinate, so the coefficients
// of a cell follow from the vector areas and first moments of the boundary in its octants, and
// those of the parent from the same numbers of its octants. So the surface is cut along the finest
// cells only, once, and all coarser coefficients are sums.
//
// The printed F for wavelets along several axes take everything from x. The mean of the choices for
// each axis of the wavelet has the same compact support, and treats the axes alike: c^e is the mean
// over the axes a in e of the flux of Psi(p_a) times the psi of e's other axes along a. Where parts
// of the surface are missing this lowers the largest error that they can cause.
#pragma once

#include <array>

#include "prefilter/wavelet/cell_polygon.h"
#include "prefilter/wavelet/cell_tree.h"

namespace prefilter {

/// Integrals over the boundary within a cell, in coordinates that make it the unit cube.
struct BoundaryFlux {
  Vector3 area{};    // of the normal n, outward
  Vector3 moment{};  // of p_x n_x, p_y n_y, p_z n_z

  void add(const BoundaryFlux& other) {
    for (int a = 0; a < 3; ++a) {
      area[a] += other.area[a];
      moment[a] += other.moment[a];
    }
  }
};

/// The flux of a piece of boundary, in the coordinates of the unit cell with this low corner.
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

/// The flux of a cell whose octants have these.
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

/// The seven coefficients [1] to [7] of a cell whose octants have these; [0] is 0.
inline OctantValues details_of_octants(const std::array<BoundaryFlux, 8>& octants) {
  std::array<double, 8> details{};
  for (int axis = 0; axis < 3; ++axis) {
    const int b = 1 << ((axis + 1) % 3);
    const int c = 1 << ((axis + 2) % 3);
    const int bit = 1 << axis;
    // The flux of Psi, which is p on the lower half and 1 - p on the upper one, in the four columns
    // of octants along the axis.
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
