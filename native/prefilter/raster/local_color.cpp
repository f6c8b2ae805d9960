// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/raster/local_color.h"

#include "prefilter/raster/channel_count.h"

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
                         const ChannelValues& along_v, int channels, const ColorPowers& moments,
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

ChannelValues LocalColor::at(const Point2& point) const {
  ChannelValues value = layer_.paint.at(point);
  for (const Paint& veil : layer_.veils) {
    const double passing = 1.0 - veil.at(point)[kMaxChannels - 1];
    for (double& channel : value) channel *= passing;
  }
  return value;
}

LocalColor::LocalColor(const RasterLayer& layer, const CellFilter& filter)
    : layer_(layer), filter_(filter) {
  if (layer.veils.empty()) round_ = RoundGradient::of(layer.paint, 1.0 / filter.cells_per_pixel);
}

void LocalColor::powers(int column, int row, std::array<ColorPowers, kMaxChannels>* out) const {
  const Point2 center = center_of(column, row);
  const Paint& paint = layer_.paint;
  if (is_linear()) {
    const double scale = 1.0 / filter_.cells_per_pixel;
    for (int c = 0; c < paint.channels; ++c) {
      (*out)[c] = {paint.constant[c] + center.x * paint.along_x[c] + center.y * paint.along_y[c],
                   scale * paint.along_x[c],
                   scale * paint.along_y[c],
                   0.0,
                   0.0,
                   0.0};
    }
  } else if (!round_ || !round_->powers(center, out)) {
    node_powers(column, row, out);
  }
}

void LocalColor::node_powers(int column, int row,
                             std::array<ColorPowers, kMaxChannels>* out) const {
  const double scale = 1.0 / filter_.cells_per_pixel;
  const Point2 center = center_of(column, row);
  if (round_ && round_->node_powers(center, out)) return;
  for (ColorPowers& powers : *out) powers = {};
  for (std::size_t i = 0; i < kColorNodes; ++i) {
    const Point2 place = center + scale * color_node(i);
    add_color_node(i, round_ ? round_->at(place) : at(place), layer_.paint.channels, out);
  }
}

void LocalColor::add_integral(int column, int row, const ColorPowers& moments, double* out) const {
  const int channels = this->channels();
  if (is_linear()) {
    const Paint& paint = layer_.paint;
    const Point2 center = center_of(column, row);
    const double scale = 1.0 / filter_.cells_per_pixel;
    ChannelValues value;
    ChannelValues along_u;
    ChannelValues along_v;
    for (int c = 0; c < kMaxChannels; ++c) {
      value[c] = paint.constant[c] + center.x * paint.along_x[c] + center.y * paint.along_y[c];
      along_u[c] = scale * paint.along_x[c];
      along_v[c] = scale * paint.along_y[c];
    }
    add_linear_integral(value, along_u, along_v, channels, moments, out);
    return;
  }
  std::array<ColorPowers, kMaxChannels> powers;
  this->powers(column, row, &powers);
  for (int c = 0; c < channels; ++c) {
    double sum = 0.0;
    for (std::size_t k = 0; k < moments.size(); ++k) sum += powers[c][k] * moments[k];
    out[c] += sum;
  }
}

void LocalColor::add_means(int begin, int end, int row, double share, double* out) const {
  const Paint& paint = layer_.paint;
  const int channels = paint.channels;
  std::array<ColorPowers, kMaxChannels> powers;
  for (int column = begin; column < end;) {
    const Point2 center = center_of(column, row);
    if (is_linear()) {
      const double scale = 1.0 / filter_.cells_per_pixel;
      ChannelValues first{};
      ChannelValues step{};
      for (int c = 0; c < channels; ++c) {
        first[c] =
            share * (paint.constant[c] + center.x * paint.along_x[c] + center.y * paint.along_y[c]);
        step[c] = share * scale * paint.along_x[c];
      }
      add_linear(first, step, channels, end - begin, out);
      return;
    }
    double* to = out + static_cast<std::ptrdiff_t>(column - begin) * channels;
    const int done = round_ ? round_->add_means(center, end - column, share, to) : 0;
    column += done;
    if (column == end) return;
    to += static_cast<std::ptrdiff_t>(done) * channels;
    node_powers(column, row, &powers);
    for (int c = 0; c < channels; ++c) {
      to[c] += share * (powers[c][0] + (powers[c][3] + powers[c][5]) / 12.0);
    }
    ++column;
  }
}

}  // namespace prefilter
