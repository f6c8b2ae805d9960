// SPDX-License-Identifier: GPL-3.0-or-later

#include "bench/sampling/scenes.h"

#include <algorithm>
#include <cmath>
#include <random>

namespace prefilter::bench {
namespace {

void add(Samples& samples, double u, double v, double scale) {
  samples.float_coordinates.push_back({static_cast<float>(u), static_cast<float>(v)});
  samples.float_scales.push_back(static_cast<float>(scale));
  samples.coordinates.push_back(
      {samples.float_coordinates.back()[0], samples.float_coordinates.back()[1]});
  samples.scales.push_back(samples.float_scales.back());
}

/// A pixel of a picture with `side` pixels along each edge: the plane is turned, and each row lies
/// farther off than the one before.
void add_pixel(Samples& samples, int side, int column, int row) {
  const double mip_value = 0.5 + 3.0 * (row + 0.5) / side;
  const double scale = std::exp2(mip_value);
  const double x = (column + 0.5 - side / 2.0) * scale;
  // The position of rows at that distance: the integral of the scale over them.
  const double y = (scale - std::sqrt(2.0)) * side / (3.0 * std::log(2.0));
  const auto wrapped = [](double texels) { return texels / kSide - std::floor(texels / kSide); };
  add(samples, wrapped(0.94 * x - 0.342 * y), wrapped(0.342 * x + 0.94 * y), scale);
}

}  // namespace

Texture::Texture() {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> noise(0.0F, 0.5F);
  for (int side = kSide; side > 0; side /= 2) {
    auto& level = floats.emplace_back();
    for (int i = 0; i < side * side; ++i) {
      const float wave =
          0.25F + 0.25F * std::sin(40.0F * static_cast<float>(i % side) / static_cast<float>(side));
      for (int c = 0; c < kChannels; ++c) level.push_back(wave + noise(random));
    }
    auto& rounded = bytes.emplace_back();
    for (const float value : level) {
      rounded.push_back(static_cast<std::uint8_t>(std::lround(255.0F * value)));
    }
  }
}

Pyramid Texture::view(bool of_bytes) const {
  std::vector<PyramidLevel> views;
  for (std::size_t i = 0; i < floats.size(); ++i) {
    const void* texels = of_bytes ? static_cast<const void*>(bytes[i].data())
                                  : static_cast<const void*>(floats[i].data());
    views.push_back({texels, kSide >> i, kSide >> i});
  }
  return {std::move(views), kChannels, of_bytes};
}

std::vector<Samples> samples_of_scenes(std::size_t count) {
  std::vector<Samples> found(3);
  std::mt19937 random(2);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  found[0].name = "random";
  for (std::size_t i = 0; i < count; ++i) {
    const double u = unit(random);
    const double v = unit(random);
    add(found[0], u, v, std::exp2(5.0 * unit(random)));
  }
  const int side = static_cast<int>(std::sqrt(static_cast<double>(count))) / 8 * 8;
  found[1].name = "rows";
  for (int row = 0; row < side; ++row) {
    for (int column = 0; column < side; ++column) add_pixel(found[1], side, column, row);
  }
  found[2].name = "quads";
  for (int tile = 0; tile < side * side / 64; ++tile) {
    for (int quad = 0; quad < 16; ++quad) {
      for (int i = 0; i < 4; ++i) {
        add_pixel(found[2], side, tile % (side / 8) * 8 + quad % 4 * 2 + i % 2,
                  tile / (side / 8) * 8 + quad / 4 * 2 + i / 2);
      }
    }
  }
  return found;
}

}  // namespace prefilter::bench
