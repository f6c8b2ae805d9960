// SPDX-License-Identifier: GPL-3.0-or-later

// Images: interleaved float channels, row 0 at v = 0.
#pragma once

#include <array>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace prefilter {

/// Maximum number of channels of an image.
inline constexpr int kMaxChannels = 4;

/// A view of interleaved rows without padding: texel (x, y), channel c is at data[(y * width + x) *
/// channels + c].
struct ImageView {
  const float* data = nullptr;
  int width = 0;     // texels
  int height = 0;    // texels
  int channels = 0;  // 1 to kMaxChannels

  const float* texel(int x, int y) const {
    assert(x >= 0 && x < width && y >= 0 && y < height);
    return data + (static_cast<std::ptrdiff_t>(y) * width + x) * channels;
  }
  std::size_t texel_count() const {
    return static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  }
  std::size_t value_count() const { return texel_count() * static_cast<std::size_t>(channels); }
};

/// Values of the 256 bytes, per channel.
using ByteValues = std::array<std::array<float, 256>, kMaxChannels>;

/// The stored texels of an image: floats, or bytes with a table of values. Bytes are converted to
/// floats when read, so that byte images need no further memory.
class TexelSource {
 public:
  // NOLINTNEXTLINE(google-explicit-constructor): an image of floats is one
  TexelSource(const ImageView& floats)
      : width(floats.width), height(floats.height), channels(floats.channels), floats_(floats) {}
  /// Interleaved rows without padding, like ImageView.
  TexelSource(const std::uint8_t* bytes, int width_, int height_, int channels_,
              const ByteValues* values)
      : width(width_), height(height_), channels(channels_), bytes_(bytes), values_(values) {}

  bool has_bytes() const { return bytes_ != nullptr; }
  const ImageView& floats() const { return floats_; }
  const std::uint8_t* byte_texel(int x, int y) const {
    assert(x >= 0 && x < width && y >= 0 && y < height);
    return bytes_ + (static_cast<std::ptrdiff_t>(y) * width + x) * channels;
  }
  float value(std::uint8_t byte, int channel) const { return (*values_)[channel][byte]; }

  int width;
  int height;
  int channels;

 private:
  ImageView floats_;
  const std::uint8_t* bytes_ = nullptr;
  const ByteValues* values_ = nullptr;
};

/// An image that owns its texels, in the layout of ImageView.
struct Image {
  int width = 0;
  int height = 0;
  int channels = 0;
  std::vector<float> data;

  Image() = default;
  Image(int width_, int height_, int channels_, float value = 0.0F)
      : width(width_),
        height(height_),
        channels(channels_),
        data(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_) *
                 static_cast<std::size_t>(channels_),
             value) {}
  explicit Image(const ImageView& view)
      : width(view.width),
        height(view.height),
        channels(view.channels),
        data(view.data, view.data + view.value_count()) {}

  float* texel(int x, int y) { return data.data() + offset(x, y); }
  const float* texel(int x, int y) const { return data.data() + offset(x, y); }
  ImageView view() const { return {data.data(), width, height, channels}; }

 private:
  std::ptrdiff_t offset(int x, int y) const {
    assert(x >= 0 && x < width && y >= 0 && y < height);
    return (static_cast<std::ptrdiff_t>(y) * width + x) * channels;
  }
};

/// Converts an image of bytes to floats.
Image to_floats(const TexelSource& bytes, int threads);

}  // namespace prefilter
