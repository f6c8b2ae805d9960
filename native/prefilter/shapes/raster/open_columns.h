// SPDX-License-Identifier: GPL-3.0-or-later

// The cells of a row in which further layers may be visible.
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace prefilter {

/// A set of columns, all open at first.
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
  /// Opens columns of a block of 16 closed ones by a bit mask; `column` is a multiple of 16.
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
  /// The first open column in [column, end), or `end`.
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
