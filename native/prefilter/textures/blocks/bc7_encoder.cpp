// SPDX-License-Identifier: GPL-3.0-or-later

// BC7 by effort: BC7F alone, which predicts the modes to try; or BC7F at its slowest settings,
// improved by bc7enc in blocks that are not close; or the closest block of both and of Convection
// Texture Tools, which search exhaustively. None of them is the closest in all blocks.
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

constexpr std::ptrdiff_t kBc7TexelBytes = 4 * 4 * 4;
constexpr std::ptrdiff_t kBc7BlockBytes = 16;
/// Makes a texel that is no longer opaque worse than any error of colors.
constexpr std::int64_t kBc7OpaqueWeight = std::int64_t{1} << 32;
/// Squared error per block up to which normal effort keeps BC7F's result: half of the color values
/// are off by at most 1/255. On photographs this costs up to 0.2 dB and halves the time.
constexpr std::int64_t kCloseEnough = 32;

class ClosestBc7Encoder final : public ByteEncoder {
 public:
  /// Later encoders skip blocks whose squared error is at most `close_enough`.
  ClosestBc7Encoder(std::vector<std::unique_ptr<ByteEncoder>> encoders, std::int64_t close_enough)
      : encoders_(std::move(encoders)),
        close_enough_(close_enough),
        decoder_(make_bcdec_decoder({BlockFormat::kBc7})) {}

  void encode(const BlockRow<std::uint8_t>& row, std::uint8_t* blocks) override {
    encoders_.front()->encode(row, blocks);
    std::vector<std::int64_t> least = errors(row, blocks);
    for (std::size_t i = 1; i < encoders_.size(); ++i) try_encoder(row, i, &least, blocks);
  }

 private:
  /// Tries another encoder on the blocks that are not close enough yet.
  void try_encoder(const BlockRow<std::uint8_t>& row, std::size_t number,
                   std::vector<std::int64_t>* least, std::uint8_t* blocks) {
    std::vector<int> far_off;
    std::vector<std::uint8_t> texels;
    for (int i = 0; i < row.count; ++i) {
      if ((*least)[static_cast<std::size_t>(i)] <= close_enough_) continue;
      far_off.push_back(i);
      const std::uint8_t* from = row.texels + kBc7TexelBytes * i;
      texels.insert(texels.end(), from, from + kBc7TexelBytes);
    }
    if (far_off.empty()) return;
    const BlockRow<std::uint8_t> part{texels.data(), static_cast<int>(far_off.size()),
                                      row.rows_inside,
                                      far_off.back() == row.count - 1 ? row.last_columns : 4};
    std::vector<std::uint8_t> others(static_cast<std::size_t>(kBc7BlockBytes * part.count));
    encoders_[number]->encode(part, others.data());
    const std::vector<std::int64_t> found = errors(part, others.data());
    for (std::size_t i = 0; i < far_off.size(); ++i) {
      std::int64_t& before = (*least)[static_cast<std::size_t>(far_off[i])];
      if (found[i] >= before) continue;
      before = found[i];
      std::copy_n(others.begin() + kBc7BlockBytes * static_cast<std::ptrdiff_t>(i), kBc7BlockBytes,
                  blocks + kBc7BlockBytes * far_off[i]);
    }
  }

  std::vector<std::int64_t> errors(const BlockRow<std::uint8_t>& row, const std::uint8_t* blocks) {
    const auto decoded = decoded_row(decoder_.get(), blocks, row.count);
    std::vector<std::int64_t> sums = squared_errors(row, decoded, {0, 0, 3});
    const std::vector<std::int64_t> of_alpha = squared_errors(row, decoded, {3, 3, 1});
    for (int i = 0; i < row.count; ++i) {
      const auto at = static_cast<std::size_t>(i);
      sums[at] +=
          (is_opaque(row.texels + kBc7TexelBytes * i) ? kBc7OpaqueWeight : 1) * of_alpha[at];
    }
    return sums;
  }

  static bool is_opaque(const std::uint8_t* texels) {
    for (std::ptrdiff_t byte = 3; byte < kBc7TexelBytes; byte += 4) {
      if (texels[byte] != 255) return false;
    }
    return true;
  }

  std::vector<std::unique_ptr<ByteEncoder>> encoders_;
  std::int64_t close_enough_;
  std::unique_ptr<ByteDecoder> decoder_;
};

}  // namespace

std::unique_ptr<ByteEncoder> make_bc7_encoder(BlockEffort effort) {
  if (effort == BlockEffort::kFast) return make_bc7f_encoder(effort);
  std::vector<std::unique_ptr<ByteEncoder>> encoders;
  encoders.push_back(make_bc7f_encoder(effort));
  encoders.push_back(make_bc7enc_encoder(effort));
  const bool is_best = effort == BlockEffort::kBest;
  if (is_best) encoders.push_back(make_cvtt_bc7_encoder());
  return std::make_unique<ClosestBc7Encoder>(std::move(encoders), is_best ? 0 : kCloseEnough);
}

}  // namespace prefilter
