// SPDX-License-Identifier: GPL-3.0-or-later

// Sparse symmetric positive definite systems between vertices, solved by factors.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/base/progress.h"

namespace prefilter {

/// One of the entries of a symmetric matrix, on its diagonal or below.
struct SparseEntry {
  std::uint32_t row;
  std::uint32_t column;  // up to the row
  double value;
};

/// The factors L D L^T of a matrix whose rows lie in space, those that meet close together.
class SparseFactors {
 public:
  /// Entries at one place add up. `places` has a point for each row: the rows are eliminated along
  /// nested cuts through them, which keeps the factors of a surface's matrix small. Throws
  /// Error(kCancelled).
  SparseFactors(std::vector<SparseEntry> lower, std::span<const Vector3> places,
                const Progress& progress);

  /// Whether the matrix was positive definite as far as rounding can tell; otherwise there are no
  /// factors.
  bool is_definite() const { return is_definite_; }

  /// Solves for the three right-hand sides in `values`, one row of the matrix each.
  void solve(std::span<Vector3> values) const;

 private:
  // Row by row, of entries whose rows and columns are steps, into the room that there is for the
  // columns. Returns false where the matrix is not definite.
  bool factorize(std::span<const SparseEntry> entries, std::span<const std::size_t> row_begins,
                 std::span<const std::uint32_t> parents, const Progress& progress);

  bool is_definite_ = true;
  std::vector<std::uint32_t> order_;  // the row that is eliminated at each step
  std::vector<double> diagonal_;
  // The columns of L below its diagonal of ones.
  std::vector<std::size_t> begins_;
  std::vector<std::uint32_t> rows_;
  std::vector<double> values_;
};

}  // namespace prefilter
