// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/images/transfer.h"

#include <algorithm>
#include <cmath>

#include "prefilter/base/elementary.h"
#include "prefilter/base/parallel.h"
#include "prefilter/images/srgb_byte_encoder.h"

namespace prefilter {
namespace {

template <typename Curve>
Image map_colors(const ImageView& image, int threads, const Curve& curve) {
  Image result(image);
  const int colors = std::min(image.channels, 3);
  parallel_for(image.height, Run(threads), [&](std::int64_t y) {
    float* texel = result.texel(0, static_cast<int>(y));
    for (int x = 0; x < image.width; ++x, texel += image.channels) {
      for (int c = 0; c < colors; ++c) texel[c] = curve(texel[c]);
    }
  });
  return result;
}

}  // namespace

float srgb_to_linear(float encoded) {
  const float magnitude = std::abs(encoded);
  const float linear = magnitude <= 0.04045F ? magnitude / 12.92F
                                             : elementary::pow((magnitude + 0.055F) / 1.055F, 2.4F);
  return std::copysign(linear, encoded);
}

float linear_to_srgb(float linear) {
  const float magnitude = std::abs(linear);
  const float encoded = magnitude <= 0.0031308F
                            ? magnitude * 12.92F
                            : 1.055F * elementary::pow(magnitude, 1.0F / 2.4F) - 0.055F;
  return std::copysign(encoded, linear);
}

Image decode_srgb(const ImageView& image, int threads) {
  return map_colors(image, threads, srgb_to_linear);
}

Image encode_srgb(const ImageView& image, int threads) {
  return map_colors(image, threads, linear_to_srgb);
}

ByteValues byte_values(bool srgb) {
  ByteValues values;
  for (int c = 0; c < kMaxChannels; ++c) {
    for (int i = 0; i < 256; ++i) {
      const float value = static_cast<float>(i) / 255.0F;
      values[c][i] = srgb && c < 3 ? srgb_to_linear(value) : value;
    }
  }
  return values;
}

std::vector<std::uint8_t> to_bytes(const ImageView& image, bool srgb, int threads) {
  std::vector<std::uint8_t> bytes(image.value_count());
  const std::size_t row_values = image.value_count() / static_cast<std::size_t>(image.height);
  const int colors = srgb ? std::min(image.channels, 3) : 0;
  const SrgbByteEncoder& encoded = SrgbByteEncoder::instance();
  parallel_for(image.height, Run(threads), [&](std::int64_t y) {
    const float* value = image.texel(0, static_cast<int>(y));
    std::uint8_t* byte = bytes.data() + static_cast<std::size_t>(y) * row_values;
    const auto nearest = [](float v) {
      return static_cast<std::uint8_t>(std::clamp(v, 0.0F, 1.0F) * 255.0F + 0.5F);
    };
    if (colors == 0) {
      std::transform(value, value + row_values, byte, nearest);
      return;
    }
    for (int x = 0; x < image.width; ++x) {
      for (int c = 0; c < colors; ++c) *byte++ = encoded(*value++);
      for (int c = colors; c < image.channels; ++c) *byte++ = nearest(*value++);
    }
  });
  return bytes;
}

}  // namespace prefilter
