// SPDX-License-Identifier: GPL-3.0-or-later

// Surfaces and images for the tests in this folder.
#pragma once

#include <random>
#include <vector>

#include "prefilter/base/image.h"
#include "prefilter/geometry/surface.h"

namespace prefilter::testing {

inline Surface random_surface(unsigned seed, int count, double low, double high) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> place(low, high);
  std::uniform_real_distribution<double> area(0.01, 1.0);
  Surface surface;
  for (int k = 0; k < count; ++k) {
    surface.uvs.push_back({});
    for (TextureCoordinate& corner : surface.uvs.back()) corner = {place(random), place(random)};
    surface.areas.push_back(area(random));
  }
  return surface;
}

inline Surface one_triangle(const std::array<TextureCoordinate, 3>& uvs, double area = 1.0) {
  Surface surface;
  surface.uvs.push_back(uvs);
  surface.areas.push_back(area);
  return surface;
}

inline Image random_image(unsigned seed, int width, int height, int channels) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> value(0.0F, 1.0F);
  Image image(width, height, channels);
  for (float& texel : image.data) texel = value(random);
  return image;
}

}  // namespace prefilter::testing
