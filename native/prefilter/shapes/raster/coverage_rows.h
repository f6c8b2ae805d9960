// SPDX-License-Identifier: GPL-3.0-or-later

// Rows of a shape's filtered coverage, held as differences from pixel to pixel.
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <vector>

namespace prefilter {

/// Coverage is added up in fractions of 2^-kCoverageBits: whole numbers, so a run of pixels that
/// nothing changes costs its two ends, and behind the last change there is exactly nothing left.
inline constexpr int kCoverageBits = 52;

class CoverageRows {
 public:
  /// The rows [0, rows) of `width` pixels, all 0.
  void reset(int width, int rows) {
    width_ = width;
    blocks_ = width / kBlock + 1;
    stride_ = static_cast<std::size_t>(blocks_) * kBlock;
    steps_.assign(stride_ * rows, 0);
    is_changed_.assign(static_cast<std::size_t>(blocks_) * rows, 0);
    is_row_changed_.assign(rows, 0);
  }
  /// From pixel x on a row is higher by this; x is up to the width.
  void add_step(int row, int x, std::int64_t step) {
    steps_[stride_ * row + x] += step;
    is_changed_[static_cast<std::size_t>(blocks_) * row + x / kBlock] = 1;
    is_row_changed_[row] = 1;
  }
  /// The steps at the pixels [begin, end) of a row, to be added to; end is up to the width + 1.
  std::int64_t* change(int row, int begin, int end) {
    std::uint8_t* changed = is_changed_.data() + static_cast<std::size_t>(blocks_) * row;
    for (int block = begin / kBlock; block <= (end - 1) / kBlock; ++block) changed[block] = 1;
    is_row_changed_[row] = 1;
    return steps_.data() + stride_ * row + begin;
  }
  bool is_changed(int row) const { return is_row_changed_[row] != 0; }

  /// Calls one(x, coverage) for pixels of which some differ, and run(begin, end, coverage) for
  /// those that are alike, from left to right; then the row is 0 again.
  template <typename One, typename Run>
  void take(int row, const One& one, const Run& run);

 private:
  static constexpr int kBlock = 16;
  static constexpr double kUnit = 1.0 / static_cast<double>(std::int64_t{1} << kCoverageBits);

  int width_ = 0;
  int blocks_ = 0;
  std::size_t stride_ = 0;
  std::vector<std::int64_t> steps_;
  std::vector<std::uint8_t> is_changed_;
  std::vector<std::uint8_t> is_row_changed_;
};

template <typename One, typename Run>
void CoverageRows::take(int row, const One& one, const Run& run) {
  std::int64_t* steps = steps_.data() + stride_ * row;
  std::uint8_t* changed = is_changed_.data() + static_cast<std::size_t>(blocks_) * row;
  std::int64_t sum = 0;
  int run_begin = 0;
  const auto end_run = [&](int end) {
    if (end > run_begin && sum != 0) run(run_begin, end, static_cast<double>(sum) * kUnit);
  };
  for (int block = 0; block < blocks_; ++block) {
    if (changed[block] == 0) continue;
    changed[block] = 0;
    const int begin = block * kBlock;
    const int end = std::min(begin + kBlock, width_);
    end_run(std::min(begin, width_));
    for (int x = begin; x < end; ++x) {
      sum += steps[x];
      one(x, static_cast<double>(sum) * kUnit);
    }
    std::memset(steps + begin, 0, kBlock * sizeof(std::int64_t));
    run_begin = end;
  }
  end_run(width_);
  is_row_changed_[row] = 0;
}

}  // namespace prefilter
