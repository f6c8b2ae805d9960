// SPDX-License-Identifier: GPL-3.0-or-later

// What a cell of the plane has to know of the curves in it, to give the Haar coefficients of the
// shape that they bound: four numbers, which nest as those of a surface do (boundary_flux.h).
//
// As there, the wavelet along both axes takes the mean of the two choices of F that have compact
// support: alpha = 1/2 in section 3.2.2.
#pragma once

#include <array>
#include <cmath>

namespace prefilter {

/// Integrals along the curves within a cell, in coordinates that make it the unit square. Outward
/// normals lie to the right, so ds n is (dy, -dx).
struct alignas(32) PlaneFlux {
  double area_x = 0.0;    // of dy
  double area_y = 0.0;    // of -dx
  double moment_x = 0.0;  // of x dy
  double moment_y = 0.0;  // of -y dx

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

/// The quadrants of a cell: bit 0 of a number is the half along x, bit 1 along y.
using QuadrantFluxes = std::array<PlaneFlux, 4>;

/// The flux of a cell whose quadrants have these.
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

/// What the means of the quadrants differ by from that of their cell.
template <typename T>
struct QuadrantSteps {
  T along_x{};  // c^(1,0): added on the lower half along x, taken away on the upper one
  T along_y{};  // c^(0,1)
  T across{};   // c^(1,1): added where both halves are lower or both upper

  std::array<T, 4> values(T mean) const {
    const T low = mean + along_y;
    const T high = mean - along_y;
    return {low + (along_x + across), low - (along_x + across), high + (along_x - across),
            high - (along_x - across)};
  }
};

/// The coefficients of a cell whose quadrants have these.
template <typename T>
QuadrantSteps<T> steps_of_quadrants(const QuadrantFluxes& q) {
  // The flux of Psi, which is p on the lower half and 1 - p on the upper one.
  const double low_row = q[0].moment_x + (q[1].area_x - q[1].moment_x);
  const double high_row = q[2].moment_x + (q[3].area_x - q[3].moment_x);
  const double low_column = q[0].moment_y + (q[2].area_y - q[2].moment_y);
  const double high_column = q[1].moment_y + (q[3].area_y - q[3].moment_y);
  return {static_cast<T>((low_row + high_row) * 0.25),
          static_cast<T>((low_column + high_column) * 0.25),
          static_cast<T>(((low_row - high_row) + (low_column - high_column)) * 0.125)};
}

}  // namespace prefilter
