// SPDX-License-Identifier: GPL-3.0-or-later

// The equations of a set's weights, with the multiplier of their sum.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace prefilter {

struct SubdomainSystem;

/// A texel that the others make up to this share of its own square is not told from them.
inline constexpr double kDependent = 1e-9;

/// The products of a set's texels, bordered by a row and a column of ones with a zero where they
/// meet, and columns of right sides behind.
struct BorderedRows {
  /// The right sides are zero.
  BorderedRows(const SubdomainSystem& system, std::span<const int> members, std::size_t sides);

  double& at(std::size_t row, std::size_t column) { return values[row * columns + column]; }
  double& side(std::size_t row, std::size_t side) { return at(row, rows + side); }

  /// Gauss and Jordan's elimination, with pivots, as the matrix is not definite: the right sides
  /// become the solutions. Returns false where a pivot is not above `least`.
  bool eliminate(double least);

  std::size_t rows;
  std::size_t columns;
  std::vector<double> values;
};

}  // namespace prefilter
