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

void LocalColor::powers(int column, int row, std::array<ColorPowers, kMaxChannels>* out) const {
  const double scale = 1.0 / filter_.cells_per_pixel;
  const Point2 center{filter_.to_pixel(column + 0.5), filter_.to_pixel(row + 0.5)};
  const Paint& paint = layer_.paint;
  if (is_linear()) {
    for (int c = 0; c < paint.channels; ++c) {
      (*out)[c] = {paint.constant[c] + center.x * paint.along_x[c] + center.y * paint.along_y[c],
                   scale * paint.along_x[c],
                   scale * paint.along_y[c],
                   0.0,
                   0.0,
                   0.0};
    }
    return;
  }
  constexpr std::array<double, 3> kNodes = {-0.38729833462074170, 0.0, 0.38729833462074170};
  constexpr std::array<double, 3> kWeights = {5.0 / 18.0, 8.0 / 18.0, 5.0 / 18.0};
  for (ColorPowers& powers : *out) powers = {};
  for (int j = 0; j < 3; ++j) {
    for (int i = 0; i < 3; ++i) {
      const double u = kNodes[i];
      const double v = kNodes[j];
      const ChannelValues value = at(center + scale * Point2{u, v});
      const double weight = kWeights[i] * kWeights[j];
      // Legendre's polynomials, each over the integral of its square.
      const double uu = 180.0 * (u * u - 1.0 / 12.0);
      const double vv = 180.0 * (v * v - 1.0 / 12.0);
      for (int c = 0; c < paint.channels; ++c) {
        const double term = weight * value[c];
        ColorPowers& powers = (*out)[c];
        powers[0] += term * (1.0 - (uu + vv) / 12.0);
        powers[1] += term * 12.0 * u;
        powers[2] += term * 12.0 * v;
        powers[3] += term * uu;
        powers[4] += term * 144.0 * u * v;
        powers[5] += term * vv;
      }
    }
  }
}

}  // namespace prefilter
