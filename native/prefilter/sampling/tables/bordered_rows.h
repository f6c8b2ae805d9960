// SPDX-License-Identifier: GPL-3.0-or-later

// The equations for the weights of a set of texels, with a Lagrange multiplier for their sum.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace prefilter {

struct SubdomainSystem;

/// A texel is linearly dependent on others if they explain all but this share of its square.
inline constexpr double kDependentTolerance = 1e-9;

/// The matrix of products of a set's texels, bordered by a row and a column of ones with a zero at
/// the corner, followed by columns of right sides.
struct BorderedRows {
  /// The right sides are initialized to zero.
  BorderedRows(const SubdomainSystem& system, std::span<const int> members, std::size_t sides);

  double& at(std::size_t row, std::size_t column) { return values[row * columns + column]; }
  double& side(std::size_t row, std::size_t side) { return at(row, rows + side); }

  /// Gauss-Jordan elimination with pivoting, as the matrix is indefinite. The right sides become
  /// the solutions. Returns false if a pivot is not above `least`.
  bool eliminate(double least);

  std::size_t rows;
  std::size_t columns;
  std::vector<double> values;
};

}  // namespace prefilter
