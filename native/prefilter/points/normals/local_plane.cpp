// SPDX-License-Identifier: GPL-3.0-or-later

// Eberly, A Robust Eigensolver for 3 x 3 Symmetric Matrices (2014), without iterations. The
// eigenvalue farthest from the other two gives its eigenvector as a cross product of rows; the
// others are found orthogonal to it.
#include "prefilter/points/normals/local_plane.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "prefilter/base/elementary.h"

namespace prefilter {
namespace {

Vector3 scaled(const Vector3& v, double scale) {
  return {v[0] * scale, v[1] * scale, v[2] * scale};
}

// Null direction of the matrix minus the eigenvalue: orthogonal to all rows.
Vector3 null_direction(const SymmetricMatrix& m, double eigenvalue) {
  const Vector3 rows[3] = {{m.xx - eigenvalue, m.xy, m.xz},
                           {m.xy, m.yy - eigenvalue, m.yz},
                           {m.xz, m.yz, m.zz - eigenvalue}};
  Vector3 longest{};
  double most = 0.0;
  for (int i = 0; i < 3; ++i) {
    const Vector3 across = cross(rows[i], rows[(i + 1) % 3]);
    const double square = dot(across, across);
    if (square > most) {
      longest = across;
      most = square;
    }
  }
  return most > 0.0 ? scaled(longest, 1.0 / std::sqrt(most)) : Vector3{0.0, 0.0, 1.0};
}

double product(const Vector3& a, const SymmetricMatrix& m, const Vector3& b) {
  return a[0] * (m.xx * b[0] + m.xy * b[1] + m.xz * b[2]) +
         a[1] * (m.xy * b[0] + m.yy * b[1] + m.yz * b[2]) +
         a[2] * (m.xz * b[0] + m.yz * b[1] + m.zz * b[2]);
}

// Eigenvector of the least eigenvalue among those orthogonal to another eigenvector.
Vector3 least_across(const SymmetricMatrix& m, const Vector3& other) {
  const bool is_steep = std::abs(other[2]) > 0.9;
  Vector3 u = cross(other, is_steep ? Vector3{1.0, 0.0, 0.0} : Vector3{0.0, 0.0, 1.0});
  u = scaled(u, 1.0 / std::sqrt(dot(u, u)));
  const Vector3 v = cross(other, u);
  const double uu = product(u, m, u);
  const double vv = product(v, m, v);
  const double uv = product(u, m, v);
  // The eigenvector of the greatest eigenvalue is at half the angle of (uu - vv, 2 uv).
  const double angle = 0.5 * elementary::atan2(2.0 * uv, uu - vv);
  const Vector3 along_u = scaled(u, -elementary::sin(angle));
  return along_u + scaled(v, elementary::cos(angle));
}

}  // namespace

Vector3 unit_or_zero(const Vector3& vector) {
  const double size = length(vector);
  return size > 0.0 && std::isfinite(size) ? 1.0 / size * vector : Vector3{};
}

SymmetricMatrix covariance(std::span<const Vector3> positions, std::uint32_t place,
                           const Neighbors& near) {
  const Vector3& own = positions[place];
  const double reach = 2.0 * near.squares().back();
  SymmetricMatrix result;
  if (!(reach > 0.0)) return result;
  Vector3 mean{};
  double sum = 0.0;
  for (std::size_t i = 0; i < near.places().size(); ++i) {
    const Vector3 offset = positions[near.places()[i]] - own;
    const double weight = 1.0 - near.squares()[i] / reach;
    for (int a = 0; a < 3; ++a) mean[a] += weight * offset[a];
    result.add_square(weight, offset);
    sum += weight;
  }
  for (double& x : mean) x /= sum;
  result.add_square(-sum, mean);
  return result;
}

Vector3 least_eigenvector(const SymmetricMatrix& matrix) {
  const double largest = std::max({std::abs(matrix.xx), std::abs(matrix.xy), std::abs(matrix.xz),
                                   std::abs(matrix.yy), std::abs(matrix.yz), std::abs(matrix.zz)});
  if (!(largest > 0.0)) return {};
  const SymmetricMatrix m = {matrix.xx / largest, matrix.xy / largest, matrix.xz / largest,
                             matrix.yy / largest, matrix.yz / largest, matrix.zz / largest};
  const double mean = (m.xx + m.yy + m.zz) / 3.0;
  const double x = m.xx - mean;
  const double y = m.yy - mean;
  const double z = m.zz - mean;
  const double spread =
      std::sqrt((x * x + y * y + z * z + 2.0 * (m.xy * m.xy + m.xz * m.xz + m.yz * m.yz)) / 6.0);
  if (!(spread > 0.0)) return {0.0, 0.0, 1.0};
  const double determinant =
      x * (y * z - m.yz * m.yz) - m.xy * (m.xy * z - m.yz * m.xz) + m.xz * (m.xy * m.yz - y * m.xz);
  const double cosine = std::clamp(determinant / (2.0 * spread * spread * spread), -1.0, 1.0);
  const double angle = elementary::acos(cosine) / 3.0;
  if (cosine <= 0.0) {
    const double least =
        mean + 2.0 * spread * elementary::cos(angle + 2.0 * std::numbers::pi / 3.0);
    return null_direction(m, least);
  }
  return least_across(m, null_direction(m, mean + 2.0 * spread * elementary::cos(angle)));
}

double flatness(const SymmetricMatrix& m, const Vector3& least) {
  const double eigenvalue = product(least, m, least);
  const double sum = m.xx + m.yy + m.zz - eigenvalue;
  if (!(sum > 0.0)) return 0.0;
  // Normalized by the sum, so that products do not overflow.
  const double xx = m.xx / sum;
  const double xy = m.xy / sum;
  const double xz = m.xz / sum;
  const double yy = m.yy / sum;
  const double yz = m.yz / sum;
  const double zz = m.zz / sum;
  const double pairs = xx * yy - xy * xy + xx * zz - xz * xz + yy * zz - yz * yz;
  return std::max(0.0, pairs - eigenvalue / sum);
}

}  // namespace prefilter
