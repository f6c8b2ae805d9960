// SPDX-License-Identifier: GPL-3.0-or-later

// The values of a band of pixel rows, to which layers add.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "prefilter/base/image.h"
#include "prefilter/base/unit_bytes.h"
#include "prefilter/raster/paint.h"

namespace prefilter {

/// Sums are of doubles: what layers add to the same color rounds to that color.
class BandValues {
 public:
  /// All rows have the background's values. What was there before is forgotten.
  void reset(int width, int rows, int channels, const ChannelValues& background) {
    width_ = width;
    channels_ = channels;
    background_ = background;
    values_.resize(static_cast<std::size_t>(width) * rows * channels);
    is_changed_.assign(rows, 0);
  }

  int channels() const { return channels_; }

  /// The values of a row, to be added to.
  double* row(int row) {
    double* values = values_.data() + row_begin(row);
    if (is_changed_[row] == 0) {
      is_changed_[row] = 1;
      fill(width_, background_, values);
    }
    return values;
  }

  /// Adds `coverage` times a color to the pixels [begin, end) of a row.
  void add(double* row, int begin, int end, double coverage, const ChannelValues& color) const {
    ChannelValues values = color;
    for (double& value : values) value *= coverage;
    double* out = row + static_cast<std::size_t>(begin) * channels_;
    for_channels([&](auto channels) {
      for (int x = begin; x < end; ++x, out += channels()) {
        for (int c = 0; c < channels(); ++c) out[c] += values[c];
      }
    });
  }

  /// The row as floats.
  void store(int row, float* out) const {
    if (is_changed_[row] == 0) {
      fill(width_, background_, out);
      return;
    }
    const std::span<const double> values = values_of(row);
    std::transform(values.begin(), values.end(), out,
                   [](double value) { return static_cast<float>(value); });
  }
  /// The row as bytes, those of its floats.
  void store(int row, std::uint8_t* out) const {
    if (is_changed_[row] == 0) {
      ChannelValues bytes;
      std::transform(background_.begin(), background_.end(), bytes.begin(), unit_byte<double>);
      fill(width_, bytes, out);
      return;
    }
    unit_bytes(values_of(row), out);
  }

 private:
  std::size_t row_begin(int row) const {
    return static_cast<std::size_t>(row) * width_ * channels_;
  }
  std::span<const double> values_of(int row) const {
    return {values_.data() + row_begin(row), static_cast<std::size_t>(width_) * channels_};
  }
  template <int C>
  struct Count {
    constexpr int operator()() const { return C; }
  };
  // Calls use with the number of channels as a constant.
  template <typename Use>
  void for_channels(const Use& use) const {
    static_assert(kMaxChannels == 4);
    if (channels_ == 1) return use(Count<1>());
    if (channels_ == 2) return use(Count<2>());
    if (channels_ == 3) return use(Count<3>());
    use(Count<4>());
  }
  template <typename T>
  void fill(int width, const ChannelValues& values, T* out) const {
    for_channels([&](auto channels) {
      for (int x = 0; x < width; ++x) {
        for (int c = 0; c < channels(); ++c) *out++ = static_cast<T>(values[c]);
      }
    });
  }

  int width_ = 0;
  int channels_ = 1;
  ChannelValues background_{};
  std::vector<double> values_;
  std::vector<std::uint8_t> is_changed_;
};

}  // namespace prefilter
