// SPDX-License-Identifier: GPL-3.0-or-later

// Textures and sample positions of the sampling benchmarks.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "prefilter/sampling/pyramid.h"

namespace prefilter::bench {

inline constexpr int kSide = 1024;  // of the image, in texels
inline constexpr int kChannels = 4;

/// An RGBA image and its levels, smooth with noise.
struct Texture {
  std::vector<std::vector<float>> floats;
  std::vector<std::vector<std::uint8_t>> bytes;

  Texture();
  Pyramid view(bool of_bytes) const;
};

/// Samples, with numbers also as floats for peers.
struct Samples {
  std::string name;
  std::vector<std::array<double, 2>> coordinates;
  std::vector<double> scales;
  std::vector<std::array<float, 2>> float_coordinates;
  std::vector<float> float_scales;

  std::size_t size() const { return coordinates.size(); }
};

/// "random": all over the image at mip values from 0 to 5. "rows": the pixels of a turned plane in
/// perspective, row by row, at mip values from 0.5 to 3.5. "quads": the same pixels, in tiles of
/// 8 x 8, and 2 x 2 within them.
std::vector<Samples> samples_of_scenes(std::size_t count);

}  // namespace prefilter::bench
