// SPDX-License-Identifier: GPL-3.0-or-later

#include "bench/textures/scene.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>
#include <vector>

namespace prefilter::bench {
namespace {

constexpr int kCharts = 8;  // along each axis

/// A square chart of side sqrt(1/2) cells, which fits its cell at any angle.
struct Chart {
  double center_u;
  double center_v;
  double angle;

  TextureCoordinate at(double s, double t) const {
    const double side = std::numbers::sqrt2 / 2.0 / kCharts;
    const double x = (s - 0.5) * side;
    const double y = (t - 0.5) * side;
    return {center_u + std::cos(angle) * x - std::sin(angle) * y,
            center_v + std::sin(angle) * x + std::cos(angle) * y};
  }
};

/// A hash of its arguments, in [0, 1).
float noise(int x, int y, int block, int channel) {
  std::uint32_t h = 0;
  for (const int value : {x, y, block, channel}) {
    h = (h ^ static_cast<std::uint32_t>(value)) * 0x7feb352dU;
    h = (h ^ (h >> 15)) * 0x846ca68bU;
    h ^= h >> 16;
  }
  return static_cast<float>(h >> 8) * 0x1p-24F;
}

void add_chart(Surface& surface, const Chart& chart, int quads, double density) {
  const double step = 1.0 / quads;
  for (int j = 0; j < quads; ++j) {
    for (int i = 0; i < quads; ++i) {
      const TextureCoordinate a = chart.at(i * step, j * step);
      const TextureCoordinate b = chart.at((i + 1) * step, j * step);
      const TextureCoordinate c = chart.at((i + 1) * step, (j + 1) * step);
      const TextureCoordinate d = chart.at(i * step, (j + 1) * step);
      const double bump = 1.0 + 0.5 * std::sin(2.0 * std::numbers::pi * (i + 0.5) * step);
      const double area = density * bump * step * step / 2.0;
      surface.uvs.push_back({a, b, c});
      surface.uvs.push_back({a, c, d});
      surface.areas.insert(surface.areas.end(), 2, area);
    }
  }
}

}  // namespace

Surface charts(int triangle_count) {
  const double per_chart = triangle_count / (2.0 * kCharts * kCharts);
  const int quads = std::max(1, static_cast<int>(std::lround(std::sqrt(per_chart))));
  std::mt19937 random(1);
  std::uniform_real_distribution<double> angle(0.0, 2.0 * std::numbers::pi);
  std::uniform_real_distribution<double> exponent(-2.0, 2.0);
  Surface surface;
  for (int row = 0; row < kCharts; ++row) {
    for (int column = 0; column < kCharts; ++column) {
      const Chart chart{(column + 0.5) / kCharts, (row + 0.5) / kCharts, angle(random)};
      add_chart(surface, chart, quads, std::exp2(exponent(random)));
    }
  }
  return surface;
}

Image detailed_picture(int size) {
  std::vector<int> blocks;
  for (int block = std::max(1, size / 4); block >= 1; block /= 2) blocks.push_back(block);
  const float count = static_cast<float>(blocks.size());
  Image image(size, size, 4, 1.0F);
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      for (int c = 0; c < 3; ++c) {
        float sum = 0.0F;
        for (const int block : blocks) sum += noise(x / block, y / block, block, c) - 0.5F;
        image.texel(x, y)[c] = std::clamp(0.5F + sum / std::sqrt(count), 0.0F, 1.0F);
      }
    }
  }
  return image;
}

}  // namespace prefilter::bench
