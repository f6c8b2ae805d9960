// SPDX-License-Identifier: GPL-3.0-or-later

// Pixel values of a band of rows, accumulated layer by layer.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "prefilter/base/image.h"
#include "prefilter/base/unit_bytes.h"
#include "prefilter/shapes/paint.h"
#include "prefilter/shapes/raster/channel_count.h"

namespace prefilter {

/// Sums are doubles, so that equal colors from several layers round to the color itself. A block of
/// 16 pixels of a row stores one value as long as all its pixels receive the same.
class BandValues {
 public:
  /// Sets all rows to the background.
  void reset(int width, int rows, int channels, const ChannelValues& background) {
    width_ = width;
    channels_ = channels;
    blocks_ = (width + kBlock - 1) / kBlock;
    background_ = background;
    const std::size_t blocks = static_cast<std::size_t>(blocks_) * rows;
    states_.assign(blocks, State::kBackground);
    if (colors_.size() < blocks) colors_.resize(blocks);
    const std::size_t values = static_cast<std::size_t>(width) * rows * channels;
    if (capacity_ < values) {
      values_ = std::make_unique_for_overwrite<double[]>(values);
      capacity_ = values;
    }
  }

  int channels() const { return channels_; }

  /// Values of the pixels [begin, end) of a row, to be added to; `end` is above `begin`.
  double* pixels(int row, int begin, int end) {
    for (int block = begin >> kBlockBits; block <= (end - 1) >> kBlockBits; ++block) {
      if (states_[block_index(row, block)] != State::kPixels) make_individual(row, block);
    }
    return values_.get() + row_begin(row) + static_cast<std::size_t>(begin) * channels_;
  }
  double* row(int row) { return pixels(row, 0, width_); }

  /// Adds `coverage` times a color to the pixels [begin, end) of a row.
  void add(int row, int begin, int end, double coverage, const ChannelValues& color) {
    ChannelValues values = color;
    for (double& value : values) value *= coverage;
    while (begin < end) {
      const int block = begin >> kBlockBits;
      const int block_end = end_of(block);
      const int to = std::min(end, block_end);
      const bool is_whole = begin == block << kBlockBits && to == block_end;
      if (is_whole && states_[block_index(row, block)] != State::kPixels) {
        add_to(values, &uniform_color(row, block));
      } else {
        add_to_pixels(values, to - begin, pixels(row, begin, to));
      }
      begin = to;
    }
  }
  /// Adds coverage_of(i) times a color to the pixels begin + i of a row, for i in [0, count).
  template <typename CoverageOf>
  void add_each(int row, int begin, int count, const CoverageOf& coverage_of,
                const ChannelValues& color) {
    double* out = pixels(row, begin, begin + count);
    with_channel_count(channels_, [&](auto channels) {
      constexpr int kChannels = channels();
      const auto pairs = channel_pairs<kChannels>(color);
      for (int i = 0; i < count; ++i, out += kChannels) {
        const double coverage = coverage_of(i);
        add_pairs<kChannels>([&](std::size_t pair) { return coverage * pairs[pair]; }, out);
      }
    });
  }

  /// Writes the row as floats.
  void store(int row, float* out) const {
    store_blocks(
        row, out, [](double value) { return static_cast<float>(value); },
        [](std::span<const double> values, float* to) {
          std::transform(values.begin(), values.end(), to,
                         [](double value) { return static_cast<float>(value); });
        });
  }
  /// Writes the row as bytes, rounded from its floats.
  void store(int row, std::uint8_t* out) const {
    store_blocks(row, out, unit_byte<double>, unit_bytes<double>);
  }

 private:
  static constexpr int kBlockBits = 4;
  static constexpr int kBlock = 1 << kBlockBits;
  enum class State : std::uint8_t {
    kBackground,
    kUniform,  // all pixels have the block's value in colors_
    kPixels,   // each pixel has its value in values_
  };

  std::size_t row_begin(int row) const {
    return static_cast<std::size_t>(row) * width_ * channels_;
  }
  std::size_t block_index(int row, int block) const {
    return static_cast<std::size_t>(row) * blocks_ + block;
  }
  int end_of(int block) const { return std::min((block + 1) << kBlockBits, width_); }

  static void add_to(const ChannelValues& values, ChannelValues* sum) {
    for (std::size_t c = 0; c < values.size(); ++c) (*sum)[c] += values[c];
  }
  void add_to_pixels(const ChannelValues& color, int count, double* out) const {
    with_channel_count(channels_, [&](auto channels) {
      constexpr int kChannels = channels();
      const auto pairs = channel_pairs<kChannels>(color);
      for (int i = 0; i < count; ++i, out += kChannels) {
        add_pairs<kChannels>([&](std::size_t pair) { return pairs[pair]; }, out);
      }
    });
  }
  // Color of a block whose pixels share it.
  ChannelValues& uniform_color(int row, int block) {
    const std::size_t index = block_index(row, block);
    if (states_[index] == State::kBackground) {
      colors_[index] = background_;
      states_[index] = State::kUniform;
    }
    return colors_[index];
  }
  // Gives each pixel of a block its own value.
  void make_individual(int row, int block) {
    const ChannelValues color = uniform_color(row, block);
    states_[block_index(row, block)] = State::kPixels;
    const int begin = block << kBlockBits;
    fill(end_of(block) - begin, color,
         values_.get() + row_begin(row) + static_cast<std::size_t>(begin) * channels_);
  }

  template <typename T>
  void fill(int width, const std::array<T, kMaxChannels>& color, T* out) const {
    const std::array<T, kMaxChannels> values = color;  // a local copy, which `out` cannot alias
    with_channel_count(channels_, [&](auto channels) {
      for (int x = 0; x < width; ++x) {
        for (int c = 0; c < channels(); ++c) *out++ = values[c];
      }
    });
  }
  // Writes a row: runs of individual pixels by store_pixels(values, out), uniform values by
  // `stored`.
  template <typename T, typename Stored, typename StorePixels>
  void store_blocks(int row, T* out, const Stored& stored, const StorePixels& store_pixels) const {
    const State* states = states_.data() + block_index(row, 0);
    for (int block = 0; block < blocks_;) {
      const State state = states[block];
      const int first = block++;
      // Joins adjacent blocks with individual values, and adjacent background blocks.
      while (block < blocks_ && states[block] == state && state != State::kUniform) ++block;
      const int begin = first << kBlockBits;
      const int count = end_of(block - 1) - begin;
      T* to = out + static_cast<std::size_t>(begin) * channels_;
      if (state == State::kPixels) {
        const double* from = values_.get() + row_begin(row) + (to - out);
        store_pixels(std::span(from, static_cast<std::size_t>(count) * channels_), to);
        continue;
      }
      const ChannelValues& color =
          state == State::kUniform ? colors_[block_index(row, first)] : background_;
      std::array<T, kMaxChannels> values;
      std::transform(color.begin(), color.end(), values.begin(), stored);
      fill(count, values, to);
    }
  }

  int width_ = 0;
  int channels_ = 1;
  int blocks_ = 0;  // per row
  ChannelValues background_{};
  std::vector<State> states_;
  std::vector<ChannelValues> colors_;
  std::unique_ptr<double[]> values_;  // of blocks in the state kPixels
  std::size_t capacity_ = 0;
};

}  // namespace prefilter
