// SPDX-License-Identifier: GPL-3.0-or-later

// Channels that have eight bytes of their own: two ends, and three bits a texel. libsquish and
// Convection Texture Tools search them in different ways, and either is closer in some blocks: so
// each block gets the closer one of both. Convection Texture Tools alone are up to 8 dB behind in
// channels of few values, and libsquish up to 4 dB in others.
#include <ConvectionKernels.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>
#include <vector>

#include "prefilter/textures/blocks/block_errors.h"
#include "prefilter/textures/blocks/decoders.h"
#include "prefilter/textures/blocks/encoders.h"

namespace prefilter {
namespace {

constexpr int kAtOnce = cvtt::NumParallelBlocks;
constexpr int kSide = 4;
constexpr int kTexels = kSide * kSide;
constexpr std::ptrdiff_t kChannels = 4;
constexpr std::ptrdiff_t kBytes = 8;

using Blocks = std::array<std::uint8_t, kBytes * kAtOnce>;

/// Where a channel of RGBA is in a block.
struct Place {
  std::ptrdiff_t channel;
  std::ptrdiff_t byte;
};

std::vector<Place> places_in(BlockFormat format) {
  if (format == BlockFormat::kBc3) return {{3, 0}};
  if (format == BlockFormat::kBc5) return {{0, 0}, {1, kBytes}};
  return {{0, 0}};
}

cvtt::Options cvtt_options(BlockEffort effort) {
  cvtt::Options options;
  // All that there is takes five times as long, and takes 2 to 4 % off the error.
  options.seedPoints = effort == BlockEffort::kBest ? 4 : 1;
  options.refineRoundsIIC = effort == BlockEffort::kBest ? 8 : 4;
  return options;
}

class ChannelEncoder final : public ByteEncoder {
 public:
  ChannelEncoder(std::unique_ptr<ByteEncoder> first, const BlockOptions& options)
      : first_(std::move(first)),
        decoder_(make_bcdec_decoder({BlockFormat::kBc4})),
        options_(cvtt_options(options.effort)),
        places_(places_in(options.format)),
        block_bytes_(layout_of(options.format).bytes) {}

  void encode(const BlockRow<std::uint8_t>& row, std::uint8_t* blocks) override {
    first_->encode(row, blocks);
    for (int i = 0; i < row.count; i += kAtOnce) {
      const int count = std::min(kAtOnce, row.count - i);
      const bool is_last = i + count == row.count;
      const BlockRow<std::uint8_t> part{row.texels + kChannels * kTexels * i, count,
                                        row.rows_inside, is_last ? row.last_columns : kSide};
      for (const Place& place : places_) {
        improve(part, place, blocks + block_bytes_ * i);
      }
    }
  }

 private:
  void improve(const BlockRow<std::uint8_t>& row, const Place& place, std::uint8_t* blocks) {
    Blocks before{};
    Blocks other{};
    for (std::ptrdiff_t i = 0; i < row.count; ++i) {
      std::copy_n(blocks + block_bytes_ * i + place.byte, kBytes, before.begin() + kBytes * i);
    }
    const auto now = errors(row, place, before);
    if (*std::max_element(now.begin(), now.end()) == 0) return;
    std::array<cvtt::PixelBlockU8, kAtOnce> texels{};
    for (std::ptrdiff_t i = 0; i < row.count; ++i) {
      // Instead of those beyond the image's edge, those inside again, each as often if it can be.
      const int columns = i == row.count - 1 ? row.last_columns : kSide;
      for (int t = 0; t < kTexels; ++t) {
        const int inside = kSide * (t / kSide % row.rows_inside) + t % kSide % columns;
        texels[static_cast<std::size_t>(i)].m_pixels[t][0] =
            row.texels[kChannels * (kTexels * i + inside) + place.channel];
      }
    }
    cvtt::Kernels::EncodeBC4U(other.data(), texels.data(), options_);
    const auto then = errors(row, place, other);
    for (std::ptrdiff_t i = 0; i < row.count; ++i) {
      const auto block = static_cast<std::size_t>(i);
      if (then[block] >= now[block]) continue;
      std::copy_n(other.begin() + kBytes * i, kBytes, blocks + block_bytes_ * i + place.byte);
    }
  }

  std::vector<std::int64_t> errors(const BlockRow<std::uint8_t>& row, const Place& place,
                                   const Blocks& blocks) {
    return squared_errors(row, decoded_row(decoder_.get(), blocks.data(), row.count),
                          {place.channel, 0, 1});
  }

  std::unique_ptr<ByteEncoder> first_;
  std::unique_ptr<ByteDecoder> decoder_;
  cvtt::Options options_;
  std::vector<Place> places_;
  std::ptrdiff_t block_bytes_;
};

}  // namespace

std::unique_ptr<ByteEncoder> make_channel_encoder(const BlockOptions& options) {
  if (options.effort == BlockEffort::kFast) return make_squish_encoder(options);
  return std::make_unique<ChannelEncoder>(make_squish_encoder(options), options);
}

}  // namespace prefilter
