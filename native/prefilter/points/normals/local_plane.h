// SPDX-License-Identifier: GPL-3.0-or-later

// The plane that fits points best.
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

/// The vector, 1 long; zero for one that is zero or not finite.
Vector3 unit_or_zero(const Vector3& vector);

/// The covariance of the neighbors of a position, around their mean; near ones count up to twice as
/// much as far ones.
SymmetricMatrix covariance(std::span<const Vector3> positions, std::uint32_t place,
                           const Neighbors& near);

/// The eigenvector, 1 long, of the least eigenvalue of a finite matrix: of the covariance of
/// points, the normal of the plane that fits them best. Where several do, one of them; zero for a
/// matrix of zeros.
Vector3 least_eigenvector(const SymmetricMatrix& matrix);

/// Of the other two eigenvalues of a covariance, the lesser one as a share of both, roughly: 0 for
/// points on a line, 1/4 for a disc. `least` is what least_eigenvector returned.
double flatness(const SymmetricMatrix& matrix, const Vector3& least);

}  // namespace prefilter
