// SPDX-License-Identifier: GPL-3.0-or-later

// "OpenEXR File Layout": tile chunks, and ZIP compression: bytes at even and odd positions are
// separated, differenced and deflated.
#include "prefilter/images/exr_tiles.h"

#include <libdeflate.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cstring>
#include <memory>
#include <new>

#include "prefilter/base/parallel.h"
#include "prefilter/images/half_float.h"

namespace prefilter {
namespace {

// Faster and smaller than the default of the OpenEXR library (zlib level 4).
constexpr int kCompressionLevel = 2;
constexpr std::int64_t kTilesPerRange = 16;
constexpr int kHeaderSize = 5 * sizeof(std::int32_t);

struct FreeCompressor {
  void operator()(libdeflate_compressor* compressor) const {
    libdeflate_free_compressor(compressor);
  }
};

// Stores a value in native byte order: all supported processors are little-endian.
template <typename T>
void put(T value, std::uint8_t* to) {
  std::memcpy(to, &value, sizeof(T));
}

class TileWriter {
 public:
  TileWriter(const TexelSource& level, int number, const ExrTileOptions& options)
      : level_(level),
        number_(number),
        options_(options),
        value_size_(options.half ? sizeof(std::uint16_t) : sizeof(float)),
        compressor_(libdeflate_alloc_compressor(kCompressionLevel)) {
    if (compressor_ == nullptr) throw std::bad_alloc();
    if (!level.has_bytes() || options.multiplies) return;
    for (int c = 0; c < level.channels; ++c) {
      for (int byte = 0; byte < 256; ++byte) {
        halves_[c][byte] = half_of(level.value(static_cast<std::uint8_t>(byte), c), c);
      }
    }
  }

  // Appends the chunk of a tile; returns its size.
  std::int64_t write(int column, int row, std::vector<std::uint8_t>* chunks) {
    gather(column, row);
    const std::size_t begin = chunks->size();
    // Data that does not compress is stored raw.
    chunks->resize(begin + kHeaderSize + raw_.size());
    std::uint8_t* data = chunks->data() + begin + kHeaderSize;
    rearrange();
    std::size_t size = libdeflate_zlib_compress(compressor_.get(), rearranged_.data(),
                                                rearranged_.size(), data, raw_.size() - 1);
    if (size == 0) {
      size = raw_.size();
      std::copy(raw_.begin(), raw_.end(), data);
    }
    const std::array<int, 5> header = {column, row, number_, number_, static_cast<int>(size)};
    for (std::size_t i = 0; i < header.size(); ++i) {
      put<std::int32_t>(header[i], chunks->data() + begin + i * sizeof(std::int32_t));
    }
    chunks->resize(begin + kHeaderSize + size);
    return static_cast<std::int64_t>(kHeaderSize + size);
  }

 private:
  bool is_alpha(int channel) const { return options_.has_alpha && channel + 1 == level_.channels; }

  std::uint16_t half_of(float value, int channel) const {
    return half_bits(is_alpha(channel) ? std::clamp(value, 0.0F, 1.0F)
                                       : std::clamp(value, -kLargestHalf, kLargestHalf));
  }

  // Gathers the values of a tile in file order: row by row and channel by channel.
  void gather(int column, int row) {
    const int x0 = column * kExrTileSide;
    const int y0 = row * kExrTileSide;
    const int width = std::min(kExrTileSide, level_.width - x0);
    const int height = std::min(kExrTileSide, level_.height - y0);
    raw_.resize(static_cast<std::size_t>(width) * height * level_.channels * value_size_);
    std::uint8_t* to = raw_.data();
    for (int y = 0; y < height; ++y) {
      const int image_row = level_.height - 1 - (y0 + y);
      // Channels are sorted by name: A, B, G, R, or A, Y.
      for (int c = level_.channels - 1; c >= 0; --c) {
        if (!level_.has_bytes()) {
          gather_floats(level_.floats().texel(x0, image_row), width, c, to);
        } else {
          gather_bytes(level_.byte_texel(x0, image_row), width, c, to);
        }
        to += width * value_size_;
      }
    }
  }

  void gather_floats(const float* texels, int width, int channel, std::uint8_t* to) const {
    const int channels = level_.channels;
    const bool multiplies = options_.multiplies && channel + 1 != channels;
    for (int x = 0; x < width; ++x, texels += channels, to += value_size_) {
      put_value(multiplies ? texels[channel] * texels[channels - 1] : texels[channel], channel, to);
    }
  }

  void gather_bytes(const std::uint8_t* texels, int width, int channel, std::uint8_t* to) const {
    const int channels = level_.channels;
    if (options_.half && !options_.multiplies) {
      const std::array<std::uint16_t, 256>& halves = halves_[channel];
      for (int x = 0; x < width; ++x, texels += channels, to += value_size_) {
        put(halves[texels[channel]], to);
      }
      return;
    }
    const bool multiplies = options_.multiplies && channel + 1 != channels;
    for (int x = 0; x < width; ++x, texels += channels, to += value_size_) {
      float value = level_.value(texels[channel], channel);
      if (multiplies) value *= level_.value(texels[channels - 1], channels - 1);
      put_value(value, channel, to);
    }
  }

  void put_value(float value, int channel, std::uint8_t* to) const {
    if (options_.half) {
      put(half_of(value, channel), to);
    } else {
      put(value, to);
    }
  }

  void rearrange() {
    // The number of bytes is even, as values have two or four.
    const std::size_t half = raw_.size() / 2;
    split_.resize(raw_.size());
    for (std::size_t i = 0; i < half; ++i) {
      split_[i] = raw_[2 * i];
      split_[half + i] = raw_[2 * i + 1];
    }
    rearranged_.resize(raw_.size());
    rearranged_[0] = split_[0];
    for (std::size_t i = 1; i < raw_.size(); ++i) {
      rearranged_[i] = static_cast<std::uint8_t>(split_[i] - split_[i - 1] + 128);
    }
  }

  const TexelSource& level_;
  int number_;
  const ExrTileOptions& options_;
  std::size_t value_size_;
  std::unique_ptr<libdeflate_compressor, FreeCompressor> compressor_;
  std::array<std::array<std::uint16_t, 256>, kMaxChannels> halves_{};
  std::vector<std::uint8_t> raw_;
  std::vector<std::uint8_t> split_;
  std::vector<std::uint8_t> rearranged_;
};

}  // namespace

ExrChunks exr_tiles(const TexelSource& level, int number, int first_row, int row_count,
                    const ExrTileOptions& options) {
  const int columns = (level.width + kExrTileSide - 1) / kExrTileSide;
  assert((first_row + row_count - 1) * kExrTileSide < level.height);
  const std::int64_t count = static_cast<std::int64_t>(columns) * row_count;
  std::vector<ExrChunks> ranges(static_cast<std::size_t>(range_count(count, kTilesPerRange)));
  parallel_ranges(count, kTilesPerRange, Run(options.threads),
                  [&](std::int64_t begin, std::int64_t end) {
                    ExrChunks& range = ranges[begin / kTilesPerRange];
                    TileWriter writer(level, number, options);
                    for (std::int64_t i = begin; i < end; ++i) {
                      range.sizes.push_back(writer.write(static_cast<int>(i % columns),
                                                         first_row + static_cast<int>(i / columns),
                                                         &range.bytes));
                    }
                  });
  ExrChunks all;
  for (const ExrChunks& range : ranges) {
    all.bytes.insert(all.bytes.end(), range.bytes.begin(), range.bytes.end());
    all.sizes.insert(all.sizes.end(), range.sizes.begin(), range.sizes.end());
  }
  return all;
}

}  // namespace prefilter
