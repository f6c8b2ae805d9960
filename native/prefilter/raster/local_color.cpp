// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/raster/local_color.h"

namespace prefilter {

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

void LocalColor::add_means(int begin, int end, int row, double share, double* out) const {
  const Paint& paint = layer_.paint;
  const int channels = paint.channels;
  std::array<ColorPowers, kMaxChannels> powers;
  for (int column = begin; column < end;) {
    const Point2 center = center_of(column, row);
    if (is_linear()) {
      const double scale = 1.0 / filter_.cells_per_pixel;
      for (int c = 0; c < channels; ++c) {
        const double first =
            share * (paint.constant[c] + center.x * paint.along_x[c] + center.y * paint.along_y[c]);
        const double step = share * scale * paint.along_x[c];
        for (int i = 0; i < end - begin; ++i) out[i * channels + c] += first + i * step;
      }
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
