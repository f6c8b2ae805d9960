#include "prefilter/color/transfer.h"

#include <algorithm>
#include <cmath>

#include "prefilter/base/parallel.h"

namespace prefilter {
namespace {

template <typename Curve>
Image map_colours(const ImageView& image, int threads, const Curve& curve) {
  Image result(image);
  const int colours = std::min(image.channels, 3);
  parallel_for(image.height, threads, Progress(), [&](std::int64_t y) {
    float* texel = result.texel(0, static_cast<int>(y));
    for (int x = 0; x < image.width; ++x, texel += image.channels) {
      for (int c = 0; c < colours; ++c) texel[c] = curve(texel[c]);
    }
  });
  return result;
}

}  // namespace

float srgb_to_linear(float encoded) {
  const float magnitude = std::abs(encoded);
  const float linear =
      magnitude <= 0.04045F ? magnitude / 12.92F : std::pow((magnitude + 0.055F) / 1.055F, 2.4F);
  return std::copysign(linear, encoded);
}

float linear_to_srgb(float linear) {
  const float magnitude = std::abs(linear);
  const float encoded = magnitude <= 0.0031308F
                            ? magnitude * 12.92F
                            : 1.055F * std::pow(magnitude, 1.0F / 2.4F) - 0.055F;
  return std::copysign(encoded, linear);
}

Image decode_srgb(const ImageView& image, int threads) {
  return map_colours(image, threads, srgb_to_linear);
}

Image encode_srgb(const ImageView& image, int threads) {
  return map_colours(image, threads, linear_to_srgb);
}

}  // namespace prefilter
