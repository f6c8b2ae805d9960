// SPDX-License-Identifier: GPL-3.0-or-later

// Linear functions of the position, in cell coordinates.
#include "prefilter/shapes/raster/local_color.h"

#include "prefilter/shapes/raster/channel_count.h"

namespace prefilter {
namespace {

// Adds first + i * step to pixel i of `count`.
void add_linear(const ChannelValues& first, const ChannelValues& step, int channels, int count,
                double* out) {
  with_channel_count(channels, [&](auto constant) {
    constexpr int kChannels = constant();
    const auto firsts = channel_pairs<kChannels>(first);
    const auto steps = channel_pairs<kChannels>(step);
    for (int i = 0; i < count; ++i) {
      const auto place = static_cast<double>(i);
      add_pairs<kChannels>([&](std::size_t pair) { return firsts[pair] + place * steps[pair]; },
                           out + static_cast<std::ptrdiff_t>(i) * kChannels);
    }
  });
}

// Adds the integral of value + u * along_u + v * along_v.
void add_linear_integral(const ChannelValues& value, const ChannelValues& along_u,
                         const ChannelValues& along_v, int channels, const LinearPowers& moments,
                         double* out) {
  with_channel_count(channels, [&](auto constant) {
    constexpr int kChannels = constant();
    const auto values = channel_pairs<kChannels>(value);
    const auto us = channel_pairs<kChannels>(along_u);
    const auto vs = channel_pairs<kChannels>(along_v);
    add_pairs<kChannels>(
        [&](std::size_t pair) {
          return values[pair] * moments[0] + us[pair] * moments[1] + vs[pair] * moments[2];
        },
        out);
  });
}

}  // namespace

void LocalColor::powers(int column, int row, std::array<LinearPowers, kMaxChannels>* out) const {
  const Point2 center{filter_.to_pixel(column + 0.5), filter_.to_pixel(row + 0.5)};
  const double scale = 1.0 / filter_.cells_per_pixel;
  for (int c = 0; c < kMaxChannels; ++c) {
    (*out)[c] = {paint_.constant[c] + center.x * paint_.along_x[c] + center.y * paint_.along_y[c],
                 scale * paint_.along_x[c], scale * paint_.along_y[c]};
  }
}

void LocalColor::add_integral(int column, int row, const LinearPowers& moments, double* out) const {
  std::array<LinearPowers, kMaxChannels> powers;
  this->powers(column, row, &powers);
  ChannelValues value;
  ChannelValues along_u;
  ChannelValues along_v;
  for (int c = 0; c < kMaxChannels; ++c) {
    value[c] = powers[c][0];
    along_u[c] = powers[c][1];
    along_v[c] = powers[c][2];
  }
  add_linear_integral(value, along_u, along_v, channels(), moments, out);
}

void LocalColor::add_means(int begin, int end, int row, double share, double* out) const {
  std::array<LinearPowers, kMaxChannels> powers;
  this->powers(begin, row, &powers);
  ChannelValues first{};
  ChannelValues step{};
  for (int c = 0; c < channels(); ++c) {
    first[c] = share * powers[c][0];
    step[c] = share * powers[c][1];
  }
  add_linear(first, step, channels(), end - begin, out);
}

}  // namespace prefilter
