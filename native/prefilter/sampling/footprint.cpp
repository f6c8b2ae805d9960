// SPDX-License-Identifier: GPL-3.0-or-later

// Singular value decomposition of a 2 x 2 matrix, in closed form.
#include "prefilter/sampling/footprint.h"

#include <algorithm>
#include <cmath>

namespace prefilter {
namespace {

// Snaps a width to a power of two if they differ by rounding only. Rotations have such widths in
// the whole image, and tables switch texels there, which must not depend on rounding.
double steady(double width) {
  if (width == 0.0) return width;
  constexpr double kRounding = 1e-9;
  int exponent = 0;
  const double fraction = std::frexp(width, &exponent);  // 1/2 to 1
  if (fraction < 0.5 * (1.0 + kRounding)) return std::ldexp(0.5, exponent);
  if (fraction > 1.0 - kRounding) return std::ldexp(1.0, exponent);
  return width;
}

// J and J J^T, scaled by the largest element of J: half the sum and half the difference of the
// diagonal of J J^T, and its off-diagonal element.
struct FootprintSquares {
  double largest = 0.0;
  double determinant = 0.0;  // of J
  double mean = 0.0;
  double half = 0.0;
  double beside = 0.0;

  explicit FootprintSquares(const TextureJacobian& jacobian) {
    for (const double value : jacobian) largest = std::max(largest, std::abs(value));
    if (largest == 0.0) return;
    const double xi = jacobian[0] / largest;
    const double xj = jacobian[1] / largest;
    const double yi = jacobian[2] / largest;
    const double yj = jacobian[3] / largest;
    determinant = xi * yj - xj * yi;
    mean = 0.5 * (xi * xi + xj * xj + yi * yi + yj * yj);
    half = 0.5 * (xi * xi + xj * xj - yi * yi - yj * yj);
    beside = xi * yi + xj * yj;
  }

  double root() const { return std::sqrt(half * half + beside * beside); }
  double larger() const { return std::sqrt(mean + root()); }
};

}  // namespace

Footprint singular_values(const TextureJacobian& jacobian) {
  const FootprintSquares squares(jacobian);
  if (squares.largest == 0.0) return {0.0, 0.0, 1.0, 0.0};
  const double major = squares.larger();
  // From the determinant, to avoid cancellation.
  const double minor = std::min(major, std::abs(squares.determinant) / major);
  // Uses the one of two forms of the eigenvector that does not suffer from cancellation.
  const double root = squares.root();
  double x = squares.half >= 0.0 ? root + squares.half : squares.beside;
  double y = squares.half >= 0.0 ? squares.beside : root - squares.half;
  const double length = std::sqrt(x * x + y * y);
  x = length > 0.0 ? x / length : 1.0;
  y = length > 0.0 ? y / length : 0.0;
  return {steady(major * squares.largest), steady(minor * squares.largest), x, y};
}

double larger_singular_value(const TextureJacobian& jacobian) {
  const FootprintSquares squares(jacobian);
  return steady(squares.larger() * squares.largest);
}

Footprint footprint_of(const TextureJacobian& jacobian, int last_level) {
  Footprint footprint = singular_values(jacobian);
  const double widest = std::ldexp(1.0, last_level);
  footprint.major = std::clamp(footprint.major, 1.0, widest);
  footprint.minor = std::clamp(footprint.minor, 1.0, widest);
  return footprint;
}

}  // namespace prefilter
