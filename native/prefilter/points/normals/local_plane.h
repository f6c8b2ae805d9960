// SPDX-License-Identifier: GPL-3.0-or-later

// Best-fitting plane of points.
#pragma once

#include <cstdint>
#include <span>

#include "prefilter/base/geometry.h"
#include "prefilter/geometry/spatial/nearest_neighbors.h"

namespace prefilter {

/// A symmetric 3 x 3 matrix.
struct SymmetricMatrix {
  double xx = 0.0;
  double xy = 0.0;
  double xz = 0.0;
  double yy = 0.0;
  double yz = 0.0;
  double zz = 0.0;

  void add_square(double weight, const Vector3& v) {
    xx += weight * v[0] * v[0];
    xy += weight * v[0] * v[1];
    xz += weight * v[0] * v[2];
    yy += weight * v[1] * v[1];
    yz += weight * v[1] * v[2];
    zz += weight * v[2] * v[2];
  }
};

/// The vector scaled to length 1; zero for a vector that is zero or not finite.
Vector3 unit_or_zero(const Vector3& vector);

/// Covariance matrix of a position's neighbors around their mean. Weights decrease from 1 at the
/// position to 1/2 at the farthest neighbor.
SymmetricMatrix covariance(std::span<const Vector3> positions, std::uint32_t place,
                           const Neighbors& near);

/// Unit eigenvector of the least eigenvalue of a finite matrix; for a covariance matrix, the normal
/// of the best-fitting plane. Any of them if there are several; zero for a zero matrix.
Vector3 least_eigenvector(const SymmetricMatrix& matrix);

/// Ratio of the middle eigenvalue of a covariance matrix to the sum of the two largest,
/// approximately: 0 for points on a line, 1/4 for a disc. `least` is the result of
/// least_eigenvector.
double flatness(const SymmetricMatrix& matrix, const Vector3& least);

}  // namespace prefilter
