// SPDX-License-Identifier: GPL-3.0-or-later

// The part of the domain of samples covered by a subdomain of a table: quadrature, and orthonormal
// polynomials on it.
#pragma once

#include <array>
#include <vector>

#include "prefilter/sampling/sampling_table.h"

namespace prefilter {

/// The powers of x, y and f that coefficients multiply, in the order of TableShape::terms.
using Terms = std::array<double, kMaxTerms>;
Terms terms_at(double x, double y, double f);

class Subdomain {
 public:
  Subdomain(const TableShape& shape, const TableSection& section, int index);

  double x_low() const { return x_low_; }
  double x_high() const { return x_high_; }
  double y_low() const { return y_low_; }
  double y_high() const { return y_high_; }
  double f_low() const { return f_low_; }
  double f_high() const { return f_high_; }
  bool has_f() const { return has_f_; }
  double volume() const;

  /// Gauss quadrature with `panels` equal panels per axis. In a triangular subdomain, y <= x, the
  /// nodes along y depend on the one along x.
  struct Node {
    double x;
    double y;
    double f;
    double weight;
  };
  std::vector<Node> quadrature(int panels) const;

 private:
  double x_low_;
  double x_high_;
  double y_low_;
  double y_high_;
  double f_low_;
  double f_high_;
  bool has_f_;  // whether there are at least two levels, so that f is not xy
  bool is_triangle_;
};

/// Polynomials of degree 1 or 2, orthonormal on a subdomain. Polynomial p has the coefficients
/// coefficients[p]; the first one is constant.
struct OrthonormalBasis {
  int count = 0;
  std::array<Terms, kMaxTerms> coefficients{};
};
OrthonormalBasis orthonormal_basis(const Subdomain& subdomain, int degree);

}  // namespace prefilter
