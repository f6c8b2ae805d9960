// SPDX-License-Identifier: GPL-3.0-or-later

// Rows of a shape's filtered coverage, stored as differences between adjacent pixels.
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <vector>

namespace prefilter {

/// Coverage is accumulated as integer multiples of 2^-kCoverageBits. A run of constant coverage
/// costs only its two ends, and behind the last change the sum is exactly 0.
inline constexpr int kCoverageBits = 52;

class CoverageRows {
 public:
  /// Sets the rows [0, rows) of `width` pixels to 0.
  void reset(int width, int rows) {
    width_ = width;
    blocks_ = width / kBlock + 1;
    stride_ = static_cast<std::size_t>(blocks_) * kBlock;
    steps_.assign(stride_ * rows, 0);
    is_changed_.assign(static_cast<std::size_t>(blocks_) * rows, 0);
    is_row_changed_.assign(rows, 0);
  }
  /// Raises a row by `step` from pixel x on; x is at most the width.
  void add_step(int row, int x, std::int64_t step) {
    steps_[stride_ * row + x] += step;
    is_changed_[static_cast<std::size_t>(blocks_) * row + x / kBlock] = 1;
    is_row_changed_[row] = 1;
  }
  /// Differences at the pixels [begin, end) of a row, to be added to; `end` is at most the width +
  /// 1.
  std::int64_t* change(int row, int begin, int end) {
    std::uint8_t* changed = is_changed_.data() + static_cast<std::size_t>(blocks_) * row;
    for (int block = begin / kBlock; block <= (end - 1) / kBlock; ++block) changed[block] = 1;
    is_row_changed_[row] = 1;
    return steps_.data() + stride_ * row + begin;
  }
  bool is_changed(int row) const { return is_row_changed_[row] != 0; }

  /// Calls one(x, coverage) for pixels in changed blocks, and use_run(begin, end, coverage) for
  /// runs of equal coverage, from left to right. Resets the row to 0.
  template <typename One, typename UseRun>
  void take(int row, const One& one, const UseRun& use_run);

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

template <typename One, typename UseRun>
void CoverageRows::take(int row, const One& one, const UseRun& use_run) {
  std::int64_t* steps = steps_.data() + stride_ * row;
  std::uint8_t* changed = is_changed_.data() + static_cast<std::size_t>(blocks_) * row;
  std::int64_t sum = 0;
  int run_begin = 0;
  const auto end_run = [&](int end) {
    if (end > run_begin && sum != 0) use_run(run_begin, end, static_cast<double>(sum) * kUnit);
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
