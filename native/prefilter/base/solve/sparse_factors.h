// SPDX-License-Identifier: GPL-3.0-or-later

// Direct solver for sparse symmetric positive definite systems between vertices.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/base/run.h"

namespace prefilter {

/// An entry of a symmetric matrix, on its diagonal or below.
struct SparseEntry {
  std::uint32_t row;
  std::uint32_t column;  // at most the row
  double value;
};

/// The factors L D L^T of a matrix whose rows have positions, and couple nearby positions.
class SparseFactors {
 public:
  /// Entries at the same position are summed. `places` has a point for each row: rows are
  /// eliminated by nested dissection of these, which keeps the factors of surface meshes small.
  /// Throws Error(kCancelled).
  SparseFactors(std::vector<SparseEntry> lower, std::span<const Vector3> places, const Run& run);

  /// Whether the matrix was positive definite up to rounding; otherwise there are no factors.
  bool is_definite() const { return is_definite_; }

  /// Solves for the three right-hand sides in `values`, which has one element per row of the
  /// matrix.
  void solve(std::span<Vector3> values) const;

 private:
  // Factorizes row by row, with entries sorted by elimination step and space allocated for the
  // columns. Returns false if the matrix is not definite.
  bool factorize(std::span<const SparseEntry> entries, std::span<const std::size_t> row_begins,
                 std::span<const std::uint32_t> parents, const Run& run);

  bool is_definite_ = true;
  std::vector<std::uint32_t> order_;  // the row eliminated at each step
  std::vector<double> diagonal_;
  // The columns of L below its unit diagonal.
  std::vector<std::size_t> begins_;
  std::vector<std::uint32_t> rows_;
  std::vector<double> values_;
};

}  // namespace prefilter
