// SPDX-License-Identifier: GPL-3.0-or-later

// Encodes with libsquish: cluster fit over all splits along the principal axis of a block's colors,
// with least squares for the endpoints (Simon Brown, "DXT Compression Techniques").
#include <squish.h>

#include <algorithm>
#include <array>

#include "prefilter/textures/blocks/encoders.h"

namespace prefilter {
namespace {

constexpr int kSquishSide = 4;

int fit_of(BlockEffort effort) {
  if (effort == BlockEffort::kFast) return squish::kColourRangeFit;
  return effort == BlockEffort::kBest ? squish::kColourIterativeClusterFit
                                      : squish::kColourClusterFit;
}

int squish_flags(const BlockOptions& options) {
  switch (options.format) {
    case BlockFormat::kBc1Rgb:
      return squish::kDxt3;
    case BlockFormat::kBc3:
      return squish::kDxt5 | (options.weigh_by_alpha ? squish::kWeightColourByAlpha : 0);
    case BlockFormat::kBc4:
      return squish::kBc4;
    case BlockFormat::kBc5:
      return squish::kBc5;
    default:
      return squish::kDxt1;
  }
}

class SquishEncoder final : public ByteEncoder {
 public:
  explicit SquishEncoder(const BlockOptions& options)
      : is_opaque_(options.format == BlockFormat::kBc1Rgb),
        flags_(squish_flags(options) | fit_of(options.effort)),
        bytes_(layout_of(options.format).bytes) {}

  void encode(const BlockRow<std::uint8_t>& row, std::uint8_t* blocks) override {
    for (int i = 0; i < row.count; ++i) {
      const int columns = i == row.count - 1 ? row.last_columns : kSquishSide;
      int inside = 0;
      for (int y = 0; y < row.rows_inside; ++y) inside |= ((1 << columns) - 1) << (kSquishSide * y);
      compress(row.texels + std::ptrdiff_t{4} * kSquishSide * kSquishSide * i, inside,
               blocks + std::ptrdiff_t{bytes_} * i);
    }
  }

 private:
  void compress(const std::uint8_t* texels, int inside, std::uint8_t* block) const {
    if (!is_opaque_) {
      squish::CompressMasked(texels, inside, block, flags_);
      return;
    }
    // The second half of a block with separate alpha: four colors, no transparency.
    std::array<std::uint8_t, 16> with_alpha{};
    squish::CompressMasked(texels, inside, with_alpha.data(), flags_);
    std::copy_n(with_alpha.begin() + 8, 8, block);
  }

  bool is_opaque_;
  int flags_;
  int bytes_;
};

}  // namespace

std::unique_ptr<ByteEncoder> make_squish_encoder(const BlockOptions& options) {
  return std::make_unique<SquishEncoder>(options);
}

}  // namespace prefilter
