// SPDX-License-Identifier: GPL-3.0-or-later

// etcpak, whose heuristics suit large images, combined with an exhaustive mode search: the closer
// result is used. Neighboring texels in coarse levels have little in common, so these gain the
// most.
#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>

#include "prefilter/textures/blocks/block_errors.h"
#include "prefilter/textures/blocks/decoders.h"
#include "prefilter/textures/blocks/encoders.h"
#include "prefilter/textures/blocks/etc2_search.h"

namespace prefilter {
namespace {

constexpr std::ptrdiff_t kEtc2Side = 4, kRgba = 4;
constexpr std::ptrdiff_t kRgbaBytes = kRgba * kEtc2Side * kEtc2Side;
constexpr std::ptrdiff_t kColorBytes = 8;

EtcTexels texels_of(const std::uint8_t* rgba, int rows, int columns) {
  EtcTexels texels{};
  for (std::ptrdiff_t t = 0; t < EtcTexels::kCount; ++t) {
    const std::ptrdiff_t x = t / kEtc2Side;
    const std::ptrdiff_t y = t % kEtc2Side;
    const std::uint8_t* texel = rgba + kRgba * (kEtc2Side * y + x);
    const auto at = static_cast<std::size_t>(t);
    texels.colors[at] = {texel[0], texel[1], texel[2]};
    texels.weights[at] = x < columns && y < rows ? 1 : 0;
  }
  return texels;
}

class Etc2Encoder final : public ByteEncoder {
 public:
  Etc2Encoder(std::unique_ptr<ByteEncoder> first, const BlockOptions& options)
      : first_(std::move(first)),
        decoder_(make_etcpak_decoder({options.format})),
        block_bytes_(layout_of(options.format).bytes) {}

  void encode(const BlockRow<std::uint8_t>& row, std::uint8_t* blocks) override {
    first_->encode(row, blocks);
    const auto errors =
        squared_errors(row, decoded_row(decoder_.get(), blocks, row.count), {0, 0, 3});
    for (int i = 0; i < row.count; ++i) {
      const std::int64_t error = errors[static_cast<std::size_t>(i)];
      if (error == 0) continue;
      const int columns = i == row.count - 1 ? row.last_columns : static_cast<int>(kEtc2Side);
      const EtcTexels texels = texels_of(row.texels + kRgbaBytes * i, row.rows_inside, columns);
      const EtcBlock closest = closer(closer(search_etc_plane(texels), search_etc_halves(texels)),
                                      search_etc_paints(texels));
      if (closest.error >= error) continue;
      std::uint8_t* color = blocks + block_bytes_ * (i + 1) - kColorBytes;
      for (int byte = 0; byte < kColorBytes; ++byte) {
        color[byte] = static_cast<std::uint8_t>(closest.bits >> (56 - 8 * byte));
      }
    }
  }

 private:
  std::unique_ptr<ByteEncoder> first_;
  std::unique_ptr<ByteDecoder> decoder_;
  std::ptrdiff_t block_bytes_;
};

}  // namespace

std::unique_ptr<ByteEncoder> make_etc2_encoder(const BlockOptions& options) {
  if (options.effort != BlockEffort::kBest) return make_etcpak_encoder(options);
  return std::make_unique<Etc2Encoder>(make_etcpak_encoder(options), options);
}

}  // namespace prefilter
