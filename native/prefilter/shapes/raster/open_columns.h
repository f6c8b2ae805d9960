// SPDX-License-Identifier: GPL-3.0-or-later

// Which cells of a row something may still be seen in.
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace prefilter {

/// Columns from 0, all open at first.
class OpenColumns {
 public:
  void reset(int count) {
    count_ = count;
    left_ = count;
    words_.assign(static_cast<std::size_t>(count) / 64 + 1, ~std::uint64_t{0});
  }
  void close_all(int count) {
    count_ = count;
    left_ = 0;
    words_.assign(static_cast<std::size_t>(count) / 64 + 1, 0);
  }
  /// Opens those of up to 16 closed ones by their bits, from a multiple of 16 on.
  void open(int column, std::uint16_t bits) {
    words_[static_cast<std::size_t>(column) / 64] |= std::uint64_t{bits} << (column % 64);
    left_ += std::popcount(bits);
  }
  bool any() const { return left_ > 0; }
  bool is_open(int column) const {
    return (words_[static_cast<std::size_t>(column) / 64] >> (column % 64) & 1) != 0;
  }
  void close(int column) {
    words_[static_cast<std::size_t>(column) / 64] &= ~(std::uint64_t{1} << (column % 64));
    --left_;
  }
  /// The first open one from a column on that is below `end`, or `end`.
  int next(int column, int end) const {
    end = std::min(end, count_);
    while (column < end) {
      const std::uint64_t bits = words_[static_cast<std::size_t>(column) / 64] >> (column % 64);
      if (bits != 0) return std::min(end, column + std::countr_zero(bits));
      column = (column / 64 + 1) * 64;
    }
    return end;
  }

 private:
  int count_ = 0;
  int left_ = 0;
  std::vector<std::uint64_t> words_;
};

}  // namespace prefilter
