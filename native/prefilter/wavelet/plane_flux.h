// SPDX-License-Identifier: GPL-3.0-or-later

// Curve integrals of a cell in the plane, from which the Haar coefficients of the enclosed shape
// are computed: four numbers, which nest like those of a surface (boundary_flux.h).
//
// As there, the wavelet along both axes uses the mean of the two compactly supported F: alpha = 1/2
// in section 3.2.2.
#pragma once

#include <array>
#include <cmath>

namespace prefilter {

/// Integrals along the curves within a cell, in coordinates of the unit square. The outward normal
/// is on the right, so ds n is (dy, -dx).
struct alignas(32) PlaneFlux {
  double area_x = 0.0;    // integral of dy
  double area_y = 0.0;    // integral of -dx
  double moment_x = 0.0;  // integral of x dy
  double moment_y = 0.0;  // integral of -y dx

  PlaneFlux& operator+=(const PlaneFlux& other) {
    area_x += other.area_x;
    area_y += other.area_y;
    moment_x += other.moment_x;
    moment_y += other.moment_y;
    return *this;
  }
  bool is_zero() const {
    return std::abs(area_x) + std::abs(area_y) + std::abs(moment_x) + std::abs(moment_y) == 0.0;
  }
};

/// Fluxes of the quadrants of a cell: bit 0 of the index is the half along x, bit 1 along y.
using QuadrantFluxes = std::array<PlaneFlux, 4>;

/// Flux of a cell from the fluxes of its quadrants.
inline PlaneFlux flux_of_quadrants(const QuadrantFluxes& q) {
  PlaneFlux sum;
  sum.area_x = (q[0].area_x + q[1].area_x + q[2].area_x + q[3].area_x) * 0.5;
  sum.area_y = (q[0].area_y + q[1].area_y + q[2].area_y + q[3].area_y) * 0.5;
  sum.moment_x = (q[0].moment_x + q[2].moment_x + (q[1].moment_x + q[1].area_x) +
                  (q[3].moment_x + q[3].area_x)) *
                 0.25;
  sum.moment_y = (q[0].moment_y + q[1].moment_y + (q[2].moment_y + q[2].area_y) +
                  (q[3].moment_y + q[3].area_y)) *
                 0.25;
  return sum;
}

/// Haar coefficients of a cell: differences of its quadrants' means from its own.
template <typename T>
struct QuadrantSteps {
  T along_x{};  // c^(1,0): added on the lower half along x, subtracted on the upper
  T along_y{};  // c^(0,1)
  T across{};   // c^(1,1): added if both halves are lower or both upper, else subtracted

  std::array<T, 4> values(T mean) const {
    const T low = mean + along_y;
    const T high = mean - along_y;
    return {low + (along_x + across), low - (along_x + across), high + (along_x - across),
            high - (along_x - across)};
  }
};

/// The coefficients of a cell from the fluxes of its quadrants.
template <typename T>
QuadrantSteps<T> steps_of_quadrants(const QuadrantFluxes& q) {
  // Flux of Psi, which is p on the lower half and 1 - p on the upper half.
  const double low_row = q[0].moment_x + (q[1].area_x - q[1].moment_x);
  const double high_row = q[2].moment_x + (q[3].area_x - q[3].moment_x);
  const double low_column = q[0].moment_y + (q[2].area_y - q[2].moment_y);
  const double high_column = q[1].moment_y + (q[3].area_y - q[3].moment_y);
  return {static_cast<T>((low_row + high_row) * 0.25),
          static_cast<T>((low_column + high_column) * 0.25),
          static_cast<T>(((low_row - high_row) + (low_column - high_column)) * 0.125)};
}

}  // namespace prefilter
