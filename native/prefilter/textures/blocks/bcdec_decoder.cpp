// SPDX-License-Identifier: GPL-3.0-or-later

#include <bcdec.h>

#include <algorithm>
#include <array>
#include <cstddef>

#include "prefilter/textures/blocks/decoders.h"

namespace prefilter {
namespace {

constexpr int kBcdecDecodedSide = 4;
constexpr std::ptrdiff_t kBcdecDecodedChannels = 4;

/// Copies the channels of a decoded block into a row of blocks.
template <class Channel>
void copy_block(const Channel* from, int channels, Channel* texels, std::ptrdiff_t row_channels) {
  for (int y = 0; y < kBcdecDecodedSide; ++y) {
    for (int x = 0; x < kBcdecDecodedSide; ++x) {
      std::copy_n(from, channels, texels + y * row_channels + x * kBcdecDecodedChannels);
      from += channels;
    }
  }
}

class BcdecDecoder final : public ByteDecoder {
 public:
  explicit BcdecDecoder(const DecodeOptions& options)
      : format_(options.format), bytes_(layout_of(options.format).bytes) {}

  void decode(const std::uint8_t* blocks, int count, std::uint8_t* texels) override {
    const std::ptrdiff_t row_channels = kBcdecDecodedChannels * kBcdecDecodedSide * count;
    for (int i = 0; i < count; ++i) {
      decode(blocks + std::ptrdiff_t{bytes_} * i,
             texels + kBcdecDecodedChannels * kBcdecDecodedSide * i, row_channels);
    }
  }

 private:
  void decode(const std::uint8_t* block, std::uint8_t* texels, std::ptrdiff_t row_channels) const {
    std::array<std::uint8_t, std::size_t{2} * kBcdecDecodedSide * kBcdecDecodedSide> few{};
    const int pitch = static_cast<int>(row_channels);
    switch (format_) {
      case BlockFormat::kBc3:
        return bcdec_bc3(block, texels, pitch);
      case BlockFormat::kBc4:
        bcdec_bc4(block, few.data(), kBcdecDecodedSide);
        return copy_block(few.data(), 1, texels, row_channels);
      case BlockFormat::kBc5:
        bcdec_bc5(block, few.data(), 2 * kBcdecDecodedSide);
        return copy_block(few.data(), 2, texels, row_channels);
      case BlockFormat::kBc7:
        return bcdec_bc7(block, texels, pitch);
      default:
        return bcdec_bc1(block, texels, pitch);
    }
  }

  BlockFormat format_;
  int bytes_;
};

class BcdecHalfDecoder final : public HalfDecoder {
 public:
  void decode(const std::uint8_t* blocks, int count, HalfBits* texels) override {
    constexpr int kColors = 3;
    for (int i = 0; i < count; ++i) {
      std::array<HalfBits, std::size_t{kColors} * kBcdecDecodedSide * kBcdecDecodedSide> colors{};
      bcdec_bc6h_half(blocks + std::ptrdiff_t{BCDEC_BC6H_BLOCK_SIZE} * i, colors.data(),
                      kColors * kBcdecDecodedSide, 0);
      copy_block(colors.data(), kColors, texels + kBcdecDecodedChannels * kBcdecDecodedSide * i,
                 kBcdecDecodedChannels * kBcdecDecodedSide * count);
    }
  }
};

}  // namespace

std::unique_ptr<ByteDecoder> make_bcdec_decoder(const DecodeOptions& options) {
  return std::make_unique<BcdecDecoder>(options);
}

std::unique_ptr<HalfDecoder> make_bcdec_half_decoder() {
  return std::make_unique<BcdecHalfDecoder>();
}

}  // namespace prefilter
