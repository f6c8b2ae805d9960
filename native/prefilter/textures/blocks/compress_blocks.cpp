// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/textures/compress_blocks.h"

#include <algorithm>
#include <cstddef>
#include <memory>
#include <string>
#include <type_traits>

#include "prefilter/base/error.h"
#include "prefilter/base/parallel.h"
#include "prefilter/textures/blocks/encoders.h"
#include "prefilter/textures/blocks/worker_pool.h"

namespace prefilter {
namespace {

// Blocks per task: part of a row, so that cancelling takes effect soon for any width.
constexpr int kBlocksPerTask = 64;

template <class Channel>
std::unique_ptr<BlockEncoder<Channel>> make_encoder(const BlockOptions& options);

template <>
std::unique_ptr<ByteEncoder> make_encoder<std::uint8_t>(const BlockOptions& options) {
  switch (options.format) {
    case BlockFormat::kBc3:
    case BlockFormat::kBc4:
    case BlockFormat::kBc5:
      return make_channel_encoder(options);
    case BlockFormat::kBc7:
      return make_bc7_encoder(options.effort);
    case BlockFormat::kEtc2Rgb:
    case BlockFormat::kEtc2Rgba:
      return make_etc2_encoder(options);
    case BlockFormat::kEacR11:
    case BlockFormat::kEacRg11:
      return make_etcpak_encoder(options);
    case BlockFormat::kAstc4x4:
    case BlockFormat::kAstc6x6:
    case BlockFormat::kAstc8x8:
      return make_astc_encoder(options);
    case BlockFormat::kUastc:
      return make_uastc_encoder(options.effort);
    default:
      return make_squish_encoder(options);
  }
}

template <>
std::unique_ptr<HalfEncoder> make_encoder<HalfBits>(const BlockOptions& options) {
  if (options.format == BlockFormat::kBc6h) return make_cvtt_encoder(options.effort);
  return make_astc_hdr_encoder(options);
}

/// Coarse levels lose the most, and take little time at any effort.
BlockOptions options_for(const BlockOptions& options, int width, int height) {
  BlockOptions level_options = options;
  if (std::int64_t{width} * height <= kMaxCoarseTexels) {
    const bool is_fast = options.effort == BlockEffort::kFast;
    level_options.effort = is_fast ? BlockEffort::kNormal : BlockEffort::kBest;
  }
  return level_options;
}

template <class Channel>
std::vector<std::uint8_t> compress(const Channel* rgba, int width, int height,
                                   const BlockOptions& options, const Run& run) {
  if (width < 1 || height < 1) {
    throw_invalid("image: " + std::to_string(width) + " x " + std::to_string(height) +
                  " texels; both sides must be at least 1");
  }
  const BlockLayout& layout = layout_of(options.format);
  if (layout.is_float != std::is_same_v<Channel, HalfBits>) {
    throw_invalid("format: '" + std::string(layout.name) + "' is compressed from " +
                  (layout.is_float ? "half floats" : "bytes"));
  }
  const std::int64_t columns = range_count(width, layout.columns);
  const std::int64_t rows = range_count(height, layout.rows);
  const std::int64_t parts = range_count(columns, kBlocksPerTask);
  const std::int64_t block_texels = std::int64_t{layout.columns} * layout.rows;
  std::vector<std::uint8_t> blocks(static_cast<std::size_t>(rows * columns * layout.bytes));
  const BlockOptions level_options = options_for(options, width, height);
  WorkerPool<BlockEncoder<Channel>> encoders([&] { return make_encoder<Channel>(level_options); });
  parallel_for(rows * parts, run, [&](std::int64_t index) {
    const std::int64_t row = index / parts;
    const std::int64_t first = index % parts * kBlocksPerTask;
    const std::int64_t end = std::min(first + kBlocksPerTask, columns);
    std::vector<Channel> texels(static_cast<std::size_t>(4 * block_texels * (end - first)));
    auto texel = texels.begin();
    for (std::int64_t column = first; column < end; ++column) {
      for (int y = 0; y < layout.rows; ++y) {
        const std::int64_t from_row = std::min<std::int64_t>(row * layout.rows + y, height - 1);
        for (int x = 0; x < layout.columns; ++x) {
          const std::int64_t from = std::min<std::int64_t>(column * layout.columns + x, width - 1);
          texel = std::copy_n(rgba + 4 * (from_row * width + from), 4, texel);
        }
      }
    }
    const auto inside = [](std::int64_t start, int side, int size) {
      return static_cast<int>(std::min<std::int64_t>(side, size - start));
    };
    const BlockRow<Channel> part{texels.data(), static_cast<int>(end - first),
                                 inside(row * layout.rows, layout.rows, height),
                                 inside((end - 1) * layout.columns, layout.columns, width)};
    auto encoder = encoders.take();
    encoder->encode(part, blocks.data() + (row * columns + first) * layout.bytes);
    encoders.put_back(std::move(encoder));
  });
  return blocks;
}

}  // namespace

std::vector<std::uint8_t> compress_blocks(const std::uint8_t* rgba, int width, int height,
                                          const BlockOptions& options, const Run& run) {
  return compress(rgba, width, height, options, run);
}

std::vector<std::uint8_t> compress_blocks(const HalfBits* rgba, int width, int height,
                                          const BlockOptions& options, const Run& run) {
  return compress(rgba, width, height, options, run);
}

}  // namespace prefilter
