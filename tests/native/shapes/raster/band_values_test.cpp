// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/shapes/raster/band_values.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <random>
#include <vector>

namespace prefilter {
namespace {

constexpr int kRows = 3;

// The reference: a value for each pixel from the start.
struct PlainBand {
  PlainBand(int width_, int channels_, const ChannelValues& background)
      : width(width_), channels(channels_), values(width_ * kRows * channels_) {
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = background[i % channels];
  }
  void add(int row, int begin, int end, double coverage, const ChannelValues& color) {
    for (int x = begin; x < end; ++x) {
      for (int c = 0; c < channels; ++c) {
        values[(row * width + x) * channels + c] += coverage * color[c];
      }
    }
  }

  int width;
  int channels;
  std::vector<double> values;
};

void expect_equal(BandValues* found, const PlainBand& plain) {
  const std::size_t row_size = static_cast<std::size_t>(plain.width) * plain.channels;
  std::vector<float> floats(row_size);
  std::vector<std::uint8_t> bytes(row_size);
  // Stored before pixels are requested, which would give them individual values.
  for (int row = 0; row < kRows; ++row) {
    const double* expected = plain.values.data() + row * row_size;
    found->store(row, floats.data());
    found->store(row, bytes.data());
    for (std::size_t i = 0; i < row_size; ++i) {
      ASSERT_EQ(floats[i], static_cast<float>(expected[i]));
      ASSERT_EQ(bytes[i], unit_byte(expected[i]));
    }
  }
  for (int row = 0; row < kRows; ++row) {
    const double* values = found->row(row);
    for (std::size_t i = 0; i < row_size; ++i) {
      ASSERT_EQ(values[i], plain.values[row * row_size + i]);
    }
  }
}

TEST(BandValues, MatchIndividualPixels) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> unit(-0.2, 1.0);
  const auto any_color = [&] {
    return ChannelValues{unit(random), unit(random), unit(random), unit(random)};
  };
  BandValues band;  // reused for other sizes, as threads do
  for (int trial = 0; trial < 200; ++trial) {
    const int width = 1 + trial * 7 % 75;
    const int channels = 1 + trial % kMaxChannels;
    const ChannelValues background = any_color();
    PlainBand plain(width, channels, background);
    band.reset(width, kRows, channels, background);
    std::uniform_int_distribution<int> place(0, width);
    for (int step = 0; step < trial % 9; ++step) {
      const int row = step % kRows;
      const int from = step % 4 == 0 ? 0 : place(random);
      const int to = step % 4 == 0 ? width : place(random);
      const int begin = std::min(from, to);
      const int end = std::max(from, to);
      const ChannelValues color = any_color();
      const double coverage = unit(random);
      plain.add(row, begin, end, coverage, color);
      if (step % 3 < 2) {
        band.add(row, begin, end, coverage, color);
      } else if (begin < end) {
        band.add_each(
            row, begin, end - begin, [&](int) { return coverage; }, color);
      }
    }
    expect_equal(&band, plain);
  }
}

}  // namespace
}  // namespace prefilter
