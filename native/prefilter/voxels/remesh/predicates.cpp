// SPDX-License-Identifier: GPL-3.0-or-later

// Signs of determinants: evaluates them in floating point if the error bound allows it, and
// otherwise exactly as nonoverlapping expansions (J. Shewchuk, Adaptive precision floating-point
// arithmetic and fast robust geometric predicates, 1997).
#include "prefilter/voxels/remesh/predicates.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace prefilter {
namespace {

// Error bounds relative to the product of the largest differences: each of the six products of a
// 3x3 determinant is off by at most 8 roundings, each of the two of a 2x2 determinant by 5; the
// remainder covers the bound's own rounding.
constexpr double kPlaneSideError = 8e-15;
constexpr double kTurnError = 2e-15;
// Smaller bounds may be denormal.
constexpr double kMinPredicateBound = 1e-280;

int sign_of(double value) { return (value > 0.0 ? 1 : 0) - (value < 0.0 ? 1 : 0); }

// A number as the unevaluated sum of its nearest double, `high`, and the remainder `low`.
struct Split {
  double high;
  double low;
};

Split exact_sum(double a, double b) {
  const double sum = a + b;
  const double b_part = sum - a;
  const double a_part = sum - b_part;
  return {sum, (a - a_part) + (b - b_part)};
}

// Splits a number into two parts of 26 bits, whose products are exact (T. Dekker, A floating-point
// technique for extending the available precision, 1971).
Split halves(double a) {
  const double scaled = 134217729.0 * a;  // 2^27 + 1
  const double high = scaled - (scaled - a);
  return {high, a - high};
}

// Does not use std::fma, which rounds twice in the C library of Windows.
Split exact_product(double a, double b) {
  const double product = a * b;
  const Split x = halves(a);
  const Split y = halves(b);
  const double error = product - x.high * y.high - x.low * y.high - x.high * y.low;
  return {product, x.low * y.low - error};
}

// A sum of nonoverlapping doubles, in increasing order of magnitude.
class Expansion {
 public:
  void add(double value) {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < count_; ++i) {
      const Split sum = exact_sum(value, terms_[i]);
      if (sum.low != 0.0) terms_[kept++] = sum.low;
      value = sum.high;
    }
    if (value != 0.0) terms_[kept++] = value;
    count_ = kept;
  }

  void add_product(double a, double b) {
    if (a == 0.0 || b == 0.0) return;
    const Split product = exact_product(a, b);
    add(product.low);
    add(product.high);
  }

  int sign() const { return count_ == 0 ? 0 : sign_of(terms_[count_ - 1]); }

 private:
  static constexpr std::size_t kMostTerms =
      6 * 8 * 4;  // products, of parts, two doubles twice each
  std::array<double, kMostTerms + 1> terms_;
  std::size_t count_ = 0;
};

using SplitVector = std::array<Split, 3>;

SplitVector exact_difference(const Vector3& a, const Vector3& b) {
  SplitVector difference;
  for (std::size_t i = 0; i < 3; ++i) difference[i] = exact_sum(a[i], -b[i]);
  return difference;
}

void add_product(const Split& x, const Split& y, const Split& z, double sign, Expansion* sum) {
  for (const double a : {x.low, x.high}) {
    for (const double b : {y.low, y.high}) {
      if (a == 0.0 || b == 0.0) continue;
      const Split product = exact_product(a, sign * b);
      for (const double c : {z.low, z.high}) {
        sum->add_product(product.low, c);
        sum->add_product(product.high, c);
      }
    }
  }
}

int exact_plane_side(const Vector3& a, const Vector3& b, const Vector3& c, const Vector3& d) {
  const SplitVector u = exact_difference(b, a);
  const SplitVector v = exact_difference(c, a);
  const SplitVector w = exact_difference(d, a);
  Expansion sum;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t j = (i + 1) % 3;
    const std::size_t k = (i + 2) % 3;
    add_product(u[i], v[j], w[k], 1.0, &sum);
    add_product(u[i], v[k], w[j], -1.0, &sum);
  }
  return sum.sign();
}

int exact_turn(std::size_t i, std::size_t j, const Vector3& a, const Vector3& b, const Vector3& c) {
  const SplitVector u = exact_difference(b, a);
  const SplitVector v = exact_difference(c, a);
  Expansion sum;
  for (const double x : {u[i].low, u[i].high}) {
    for (const double y : {v[j].low, v[j].high}) sum.add_product(x, y);
  }
  for (const double x : {u[j].low, u[j].high}) {
    for (const double y : {v[i].low, v[i].high}) sum.add_product(x, -y);
  }
  return sum.sign();
}

double largest(double a, double b) { return std::max(std::abs(a), std::abs(b)); }
double largest(double a, double b, double c) { return std::max(largest(a, b), std::abs(c)); }
}  // namespace

int plane_side(const Vector3& a, const Vector3& b, const Vector3& c, const Vector3& d) {
  const Vector3 u = b - a;
  const Vector3 v = c - a;
  const Vector3 w = d - a;
  const double x = largest(u[0], v[0], w[0]);
  const double y = largest(u[1], v[1], w[1]);
  const double z = largest(u[2], v[2], w[2]);
  if (x == 0.0 || y == 0.0 || z == 0.0) return 0;
  const double determinant = dot(cross(u, v), w);
  const double bound = kPlaneSideError * x * y * z;
  if (bound > kMinPredicateBound && std::abs(determinant) > bound) return sign_of(determinant);
  return exact_plane_side(a, b, c, d);
}

int turn_along(int axis, const Vector3& a, const Vector3& b, const Vector3& c) {
  const auto i = static_cast<std::size_t>(axis + 1) % 3;
  const auto j = static_cast<std::size_t>(axis + 2) % 3;
  const Vector3 u = b - a;
  const Vector3 v = c - a;
  const double x = largest(u[i], v[i]);
  const double y = largest(u[j], v[j]);
  if (x == 0.0 || y == 0.0) return 0;
  const double determinant = u[i] * v[j] - u[j] * v[i];
  const double bound = kTurnError * x * y;
  if (bound > kMinPredicateBound && std::abs(determinant) > bound) return sign_of(determinant);
  return exact_turn(i, j, a, b, c);
}

bool are_collinear(const Vector3& a, const Vector3& b, const Vector3& c) {
  for (int axis = 0; axis < 3; ++axis) {
    if (turn_along(axis, a, b, c) != 0) return false;
  }
  return true;
}

}  // namespace prefilter
