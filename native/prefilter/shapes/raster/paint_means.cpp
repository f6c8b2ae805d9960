// SPDX-License-Identifier: GPL-3.0-or-later

// Means by RoundGradient where it applies, then by GradientMeans or quadrature.
#include "prefilter/shapes/raster/paint_means.h"

#include <algorithm>

#include "prefilter/base/gauss_rule.h"
#include "prefilter/shapes/raster/paint_bounds.h"

namespace prefilter {

PaintMeans::PaintMeans(const Paint& paint) : paint_(paint), round_(RoundGradient::of(paint, 1.0)) {
  if (paint.kind != Paint::Kind::kRadialStops) return;
  // GradientMeans takes circles as straight, which could mix in the color beyond a jump that does
  // not cut the pixel.
  if (has_fine_stops(paint) || !has_jumps(paint)) gradient_.emplace(paint);
}

ChannelValues PaintMeans::mean_of_points(const Point2& center) const {
  const GaussRule<3>& rule = gauss_rule<3>();
  ChannelValues mean{};
  for (std::size_t j = 0; j < 3; ++j) {
    for (std::size_t i = 0; i < 3; ++i) {
      const Point2 point = center + Point2{rule.nodes[i] - 0.5, rule.nodes[j] - 0.5};
      const ChannelValues value = round_ ? round_->at(point) : paint_.at(point);
      for (std::size_t c = 0; c < mean.size(); ++c) {
        mean[c] += rule.weights[i] * rule.weights[j] * value[c];
      }
    }
  }
  return mean;
}

void PaintMeans::find(int begin, int end, int row, double* out) const {
  const int channels = paint_.channels;
  if (paint_.kind == Paint::Kind::kConstant || paint_.kind == Paint::Kind::kLinear) {
    for (int x = begin; x < end; ++x) {
      for (int c = 0; c < channels; ++c) {
        *out++ =
            paint_.constant[c] + (x + 0.5) * paint_.along_x[c] + (row + 0.5) * paint_.along_y[c];
      }
    }
    return;
  }
  std::fill_n(out, (end - begin) * channels, 0.0);
  for (int x = begin; x < end;) {
    const Point2 center{x + 0.5, row + 0.5};
    if (round_) {
      const int added = round_->add_means(center, end - x, 1.0, out);
      out += added * channels;
      x += added;
      if (x == end) return;
    }
    const Point2 pixel{x + 0.5, row + 0.5};
    const ChannelValues mean =
        gradient_ ? gradient_->mean_over_pixel(pixel) : mean_of_points(pixel);
    out = std::copy_n(mean.begin(), channels, out);
    ++x;
  }
}

}  // namespace prefilter
