// SPDX-License-Identifier: GPL-3.0-or-later

// The values of a band of pixel rows, to which layers add.
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

/// Sums are of doubles: what layers add to the same color rounds to that color. Blocks of 16 pixels
/// of a row have one value as long as all of them are added the same.
class BandValues {
 public:
  /// All rows have the background's values. What was there before is forgotten.
  void reset(int width, int rows, int channels, const ChannelValues& background) {
    width_ = width;
    channels_ = channels;
    blocks_ = (width + kBlock - 1) / kBlock;
    background_ = background;
    const std::size_t blocks = static_cast<std::size_t>(blocks_) * rows;
    states_.assign(blocks, State::kBackground);
    if (colors_.size() < blocks) colors_.resize(blocks);
    const std::size_t values = static_cast<std::size_t>(width) * rows * channels;
    if (room_ < values) {
      values_ = std::make_unique_for_overwrite<double[]>(values);
      room_ = values;
    }
  }

  int channels() const { return channels_; }

  /// The values of the pixels [begin, end) of a row, to be added to; end is above begin.
  double* pixels(int row, int begin, int end) {
    for (int block = begin >> kBlockBits; block <= (end - 1) >> kBlockBits; ++block) {
      if (states_[block_place(row, block)] != State::kPixels) open(row, block);
    }
    return values_.get() + row_begin(row) + static_cast<std::size_t>(begin) * channels_;
  }
  /// Those of all of its pixels.
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
      if (is_whole && states_[block_place(row, block)] != State::kPixels) {
        add_to(values, &even_color(row, block));
      } else {
        add_to_pixels(values, to - begin, pixels(row, begin, to));
      }
      begin = to;
    }
  }
  /// Adds coverage_of(i) times a color to the pixel begin + i of a row, for each of `count`.
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

  /// The row as floats.
  void store(int row, float* out) const {
    store_blocks(
        row, out, [](double value) { return static_cast<float>(value); },
        [](std::span<const double> values, float* to) {
          std::transform(values.begin(), values.end(), to,
                         [](double value) { return static_cast<float>(value); });
        });
  }
  /// The row as bytes, those of its floats.
  void store(int row, std::uint8_t* out) const {
    store_blocks(row, out, unit_byte<double>, unit_bytes<double>);
  }

 private:
  static constexpr int kBlockBits = 4;
  static constexpr int kBlock = 1 << kBlockBits;
  enum class State : std::uint8_t {
    kBackground,
    kEven,    // all over the value in colors_
    kPixels,  // those in values_
  };

  std::size_t row_begin(int row) const {
    return static_cast<std::size_t>(row) * width_ * channels_;
  }
  std::size_t block_place(int row, int block) const {
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
  // The color of a block whose pixels have one.
  ChannelValues& even_color(int row, int block) {
    const std::size_t place = block_place(row, block);
    if (states_[place] == State::kBackground) {
      colors_[place] = background_;
      states_[place] = State::kEven;
    }
    return colors_[place];
  }
  // Gives a block's pixels values of their own.
  void open(int row, int block) {
    const ChannelValues color = even_color(row, block);
    states_[block_place(row, block)] = State::kPixels;
    const int begin = block << kBlockBits;
    fill(end_of(block) - begin, color,
         values_.get() + row_begin(row) + static_cast<std::size_t>(begin) * channels_);
  }

  template <typename T>
  void fill(int width, const std::array<T, kMaxChannels>& color, T* out) const {
    const std::array<T, kMaxChannels> values = color;  // which nothing else can be written to
    with_channel_count(channels_, [&](auto channels) {
      for (int x = 0; x < width; ++x) {
        for (int c = 0; c < channels(); ++c) *out++ = values[c];
      }
    });
  }
  // Calls store_pixels(values, out) for pixels of their own values, which are stored as `stored`
  // has it of one.
  template <typename T, typename Stored, typename StorePixels>
  void store_blocks(int row, T* out, const Stored& stored, const StorePixels& store_pixels) const {
    const State* states = states_.data() + block_place(row, 0);
    for (int block = 0; block < blocks_;) {
      const State state = states[block];
      const int first = block++;
      // Those with values of their own, and those without any, in one.
      while (block < blocks_ && states[block] == state && state != State::kEven) ++block;
      const int begin = first << kBlockBits;
      const int count = end_of(block - 1) - begin;
      T* to = out + static_cast<std::size_t>(begin) * channels_;
      if (state == State::kPixels) {
        const double* from = values_.get() + row_begin(row) + (to - out);
        store_pixels(std::span(from, static_cast<std::size_t>(count) * channels_), to);
        continue;
      }
      const ChannelValues& color =
          state == State::kEven ? colors_[block_place(row, first)] : background_;
      std::array<T, kMaxChannels> values;
      std::transform(color.begin(), color.end(), values.begin(), stored);
      fill(count, values, to);
    }
  }

  int width_ = 0;
  int channels_ = 1;
  int blocks_ = 0;  // of a row
  ChannelValues background_{};
  std::vector<State> states_;
  std::vector<ChannelValues> colors_;
  std::unique_ptr<double[]> values_;  // of blocks that have them
  std::size_t room_ = 0;
};

}  // namespace prefilter
