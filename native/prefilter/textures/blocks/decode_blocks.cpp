// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/textures/decode_blocks.h"

#include <algorithm>
#include <cstddef>
#include <memory>
#include <string>
#include <type_traits>

#include "prefilter/base/error.h"
#include "prefilter/base/parallel.h"
#include "prefilter/textures/blocks/decoders.h"
#include "prefilter/textures/blocks/worker_pool.h"

namespace prefilter {
namespace {

constexpr std::ptrdiff_t kDecodeBlocksChannels = 4;
constexpr HalfBits kHalfOne = 0x3c00;
constexpr std::uint8_t kByteOne = 255;

template <class Channel>
constexpr bool kIsFloat = std::is_same_v<Channel, HalfBits>;

template <class Channel>
std::unique_ptr<BlockDecoder<Channel>> make_decoder(const DecodeOptions& options);

template <>
std::unique_ptr<ByteDecoder> make_decoder<std::uint8_t>(const DecodeOptions& options) {
  switch (options.format) {
    case BlockFormat::kEtc2Rgb:
    case BlockFormat::kEtc2Rgba:
    case BlockFormat::kEacR11:
    case BlockFormat::kEacRg11:
      return make_etcpak_decoder(options);
    case BlockFormat::kAstc4x4:
    case BlockFormat::kAstc6x6:
    case BlockFormat::kAstc8x8:
      return make_astc_decoder(options);
    case BlockFormat::kUastc:
      return make_uastc_decoder();
    default:
      return make_bcdec_decoder(options);
  }
}

template <>
std::unique_ptr<HalfDecoder> make_decoder<HalfBits>(const DecodeOptions& options) {
  if (options.format == BlockFormat::kBc6h) return make_bcdec_half_decoder();
  return make_astc_hdr_decoder(options);
}

template <class Channel>
std::vector<Channel> decode(std::span<const std::uint8_t> blocks, int width, int height,
                            const DecodeOptions& options, const Run& run) {
  if (width < 1 || height < 1) {
    throw_invalid("image: " + std::to_string(width) + " x " + std::to_string(height) +
                  " texels; both sides must be at least 1");
  }
  const BlockLayout& layout = layout_of(options.format);
  if (layout.is_float != kIsFloat<Channel>) {
    throw_invalid("format: '" + std::string(layout.name) + "' is decoded to " +
                  (layout.is_float ? "half floats" : "bytes"));
  }
  const std::int64_t columns = range_count(width, layout.columns);
  const std::int64_t rows = range_count(height, layout.rows);
  const std::int64_t row_bytes = columns * layout.bytes;
  if (static_cast<std::int64_t>(blocks.size()) != rows * row_bytes) {
    throw_invalid("blocks: " + std::to_string(blocks.size()) + " bytes; " + std::to_string(width) +
                  " x " + std::to_string(height) + " texels in '" + layout.name + "' take " +
                  std::to_string(rows * row_bytes));
  }
  std::vector<Channel> image(static_cast<std::size_t>(kDecodeBlocksChannels * width * height));
  WorkerPool<BlockDecoder<Channel>> decoders([&] { return make_decoder<Channel>(options); });
  parallel_for(rows, run, [&](std::int64_t row) {
    const std::int64_t row_channels = kDecodeBlocksChannels * columns * layout.columns;
    std::vector<Channel> texels(static_cast<std::size_t>(row_channels * layout.rows));
    constexpr auto kOpaque = static_cast<Channel>(kIsFloat<Channel> ? kHalfOne : kByteOne);
    for (std::size_t i = kDecodeBlocksChannels - 1; i < texels.size(); i += kDecodeBlocksChannels)
      texels[i] = kOpaque;
    auto decoder = decoders.take();
    decoder->decode(blocks.data() + row * row_bytes, static_cast<int>(columns), texels.data());
    decoders.put_back(std::move(decoder));
    const std::int64_t inside = std::min<std::int64_t>(layout.rows, height - row * layout.rows);
    for (std::int64_t y = 0; y < inside; ++y) {
      std::copy_n(texels.data() + y * row_channels, kDecodeBlocksChannels * width,
                  image.data() + (row * layout.rows + y) * kDecodeBlocksChannels * width);
    }
  });
  return image;
}

}  // namespace

std::vector<std::uint8_t> decode_blocks(std::span<const std::uint8_t> blocks, int width, int height,
                                        const DecodeOptions& options, const Run& run) {
  return decode<std::uint8_t>(blocks, width, height, options, run);
}

std::vector<HalfBits> decode_half_blocks(std::span<const std::uint8_t> blocks, int width,
                                         int height, const DecodeOptions& options, const Run& run) {
  return decode<HalfBits>(blocks, width, height, options, run);
}

}  // namespace prefilter
