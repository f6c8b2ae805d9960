// SPDX-License-Identifier: GPL-3.0-or-later

// Rows of box-filtered coverage, stored as integer differences between adjacent pixels.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>
#include <vector>

#include "prefilter/base/double_pair.h"

namespace prefilter {

/// Coverage is counted in units of 2^-kBoxBits, modulo 2^32, which allows up to 31 windings.
/// Integers add up to the same in any order, edges shared by two shapes cancel, and behind the last
/// edge of a closed contour the sum is exactly 0.
inline constexpr int kBoxBits = 26;
inline constexpr double kBoxUnit = 1.0 / (1 << kBoxBits);

/// A band of rows. Blocks of 16 pixels without changes are skipped.
class DifferenceRows {
 public:
  /// An edge may write up to this many columns outside the image. Differences left of column 0
  /// apply to all pixels, those right of the image to none.
  static constexpr int kMargin = 4;

  /// Starts the rows [first_row, end_row) of an image. All earlier differences must have been
  /// taken.
  void begin(int width, int first_row, int end_row);

  int width() const { return width_; }
  int first_row() const { return first_row_; }
  int end_row() const { return end_row_; }

  /// The nearest column that differences may be added to.
  int clamped(int column) const { return std::clamp(column, -kMargin, width_); }

  /// A row to add to. It holds copies of the pointers, as a compiler must assume that writing marks
  /// may change members of DifferenceRows.
  struct Row {
    std::uint32_t* steps;  // at column 0
    std::uint8_t* marks;   // of the block that begins at column 0

    /// Marks the blocks from one column's to another's.
    void mark(int first, int last) const {
      for (int block = first >> kBlockBits; block <= last >> kBlockBits; ++block) marks[block] = 1;
    }
    /// Raises the row by `step` from a clamped() column on.
    void add(int column, std::uint32_t step) const {
      steps[column] += step;
      marks[column >> kBlockBits] = 1;
    }
    /// Adds to two adjacent columns.
    void add_two(int column, std::uint32_t step, std::uint32_t next) const {
      steps[column] += step;
      steps[column + 1] += next;
      marks[column >> kBlockBits] = 1;
      marks[(column + 1) >> kBlockBits] = 1;
    }
    /// Adds to four adjacent columns.
    void add_four(int column, IntFour step) const {
      std::uint32_t* to = steps + column;
      store_four(to, load_four(to) + step);
      marks[column >> kBlockBits] = 1;
      marks[(column + 3) >> kBlockBits] = 1;
    }
  };
  /// Rows up to three behind the last may be passed, but only to add zeros.
  Row row(int index) {
    const auto below = static_cast<std::ptrdiff_t>(index - first_row_);
    return {steps_.data() + below * stride_ + kBlock, is_marked_.data() + below * blocks_ + 1};
  }
  /// The row above.
  Row next(Row row) const { return {row.steps + stride_, row.marks + blocks_}; }

  /// Raises all pixels of the rows [first, end) of the band by `step`.
  void add_rows(int first, int end, std::uint32_t step) {
    if (first >= end) return;
    left_[first - first_row_] += step;
    left_[end - first_row_] -= step;
  }

  /// Calls for each row, in order, block(row, x, count, values) with 16 values of which `count` are
  /// pixels, and use_run(row, begin, end, value) for nonzero runs between blocks. Resets the rows
  /// to 0.
  template <typename Block, typename UseRun>
  void take(const Block& block, const UseRun& use_run);

 private:
  static constexpr int kBlockBits = 4;
  static constexpr int kBlock = 1 << kBlockBits;
  static constexpr int kRowsBehind = 3;

  int width_ = 0;
  int first_row_ = 0;
  int end_row_ = 0;
  // in values: one block left of column 0, and at least kMargin values right of the image
  int stride_ = 0;
  int blocks_ = 0;  // marks per row, rounded up to a multiple of 8
  std::vector<std::uint32_t> steps_;
  std::vector<std::uint8_t> is_marked_;
  std::vector<std::uint32_t> left_;  // differences between rows, at column 0
};

template <typename Block, typename UseRun>
void DifferenceRows::take(const Block& block, const UseRun& use_run) {
  std::uint32_t before = 0;
  for (int row = first_row_; row < end_row_; ++row) {
    before += left_[row - first_row_];
    left_[row - first_row_] = 0;
    std::uint32_t* steps = this->row(row).steps;
    std::uint8_t* marks = this->row(row).marks - 1;
    std::uint32_t sum = before;
    int done = 0;
    for (int group = 0; group < blocks_; group += 8) {
      std::uint64_t marked;
      std::memcpy(&marked, marks + group, sizeof(marked));
      if (marked == 0) continue;
      std::memset(marks + group, 0, sizeof(marked));
      for (; marked != 0; marked &= marked - 1) {
        // A mark is a byte of 1; the first is in the lowest bits.
        const int at = (group + std::countr_zero(marked) / 8 - 1) * kBlock;
        std::uint32_t* values = steps + at;
        if (at < 0) {
          for (int i = kBlock - kMargin; i < kBlock; ++i) {
            sum += values[i];
            values[i] = 0;
          }
          continue;
        }
        const int begin = std::min(at, width_);
        if (sum != 0 && begin > done) use_run(row, done, begin, sum);
        done = std::min(at + kBlock, width_);
        alignas(16) std::uint32_t sums[kBlock];
        IntFour last = IntFour{} + sum;
        for (int i = 0; i < kBlock; i += 4) {
          IntFour four = load_four(values + i);
          store_four(values + i, IntFour{});
          const IntFour none{};
          four += shuffle<0, 4, 5, 6>(none, four);
          four += shuffle<0, 1, 4, 5>(none, four);
          four += last;
          store_four(sums + i, four);
          last = shuffle<3, 3, 3, 3>(four, four);
        }
        sum = last[0];
        if (done > begin) block(row, begin, done - begin, sums);
      }
    }
    if (sum != 0 && width_ > done) use_run(row, done, width_, sum);
  }
  left_[end_row_ - first_row_] = 0;
}

}  // namespace prefilter
