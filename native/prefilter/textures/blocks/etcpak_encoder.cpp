// SPDX-License-Identifier: GPL-3.0-or-later

// Encodes with etcpak: both halves of a block, planar mode, and the ETC2 modes T and H if its
// heuristics favor them. For single-color blocks, which etcpak truncates to five bits, uses the
// closest block of ETC1's differential mode (Khronos Data Format 1.3, section 21.1).
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstring>
// The header below needs std::size_t.
#include <ProcessRGB.hpp>

#include "prefilter/textures/blocks/encoders.h"

namespace prefilter {
namespace {

constexpr int kEtcpakSide = 4;
constexpr int kEtcpakTexels = kEtcpakSide * kEtcpakSide;
using Texels = std::array<std::uint32_t, kEtcpakTexels>;

bool is_of_one_color(const std::uint8_t* rgba) {
  for (int t = 1; t < kEtcpakTexels; ++t) {
    if (std::memcmp(rgba, rgba + std::ptrdiff_t{4} * t, 3) != 0) return false;
  }
  return true;
}

/// The closest block to a color, with the same base for both halves.
std::array<std::uint8_t, 8> block_of_color(const std::uint8_t* rgb) {
  constexpr int kModifiers[8][2] = {{2, 8},   {5, 17},  {9, 29},   {13, 42},
                                    {18, 60}, {24, 80}, {33, 106}, {47, 183}};
  std::array<std::uint8_t, 8> nearest{};
  int least = 3 * 256 * 256;
  for (int table = 0; table < 8; ++table) {
    for (int index = 0; index < 4; ++index) {
      const int size = kModifiers[table][index & 1];
      const int modifier = index < 2 ? size : -size;
      std::array<std::uint8_t, 8> block{};
      int error = 0;
      for (std::size_t c = 0; c < 3; ++c) {
        const int base = (std::clamp(rgb[c] - modifier, 0, 255) * 31 + 127) / 255;
        const int decoded = std::clamp((base << 3 | base >> 2) + modifier, 0, 255);
        error += (decoded - rgb[c]) * (decoded - rgb[c]);
        block[c] = static_cast<std::uint8_t>(base << 3);
      }
      if (error >= least) continue;
      least = error;
      block[3] = static_cast<std::uint8_t>(table << 5 | table << 2 | 2);
      std::fill_n(block.begin() + 4, 2, static_cast<std::uint8_t>(index & 2 ? 255 : 0));
      std::fill_n(block.begin() + 6, 2, static_cast<std::uint8_t>(index & 1 ? 255 : 0));
      nearest = block;
    }
  }
  return nearest;
}

class EtcpakEncoder final : public ByteEncoder {
 public:
  explicit EtcpakEncoder(const BlockOptions& options)
      : format_(options.format), bytes_(layout_of(options.format).bytes) {}

  void encode(const BlockRow<std::uint8_t>& row, std::uint8_t* blocks) override {
    for (int i = 0; i < row.count; ++i) {
      // etcpak expects the order blue, green, red, alpha.
      Texels texels{};
      const std::uint8_t* from = row.texels + std::ptrdiff_t{4} * kEtcpakTexels * i;
      for (int t = 0; t < kEtcpakTexels; ++t) {
        const std::uint8_t* texel = from + std::ptrdiff_t{4} * t;
        const std::uint8_t swapped[] = {texel[2], texel[1], texel[0], texel[3]};
        std::memcpy(&texels[static_cast<std::size_t>(t)], swapped, sizeof swapped);
      }
      std::array<std::uint64_t, 2> block{};
      encode(texels, block.data());
      std::uint8_t* to = blocks + std::ptrdiff_t{bytes_} * i;
      std::memcpy(to, block.data(), static_cast<std::size_t>(bytes_));
      if (has_color() && is_of_one_color(from)) {
        const auto color = block_of_color(from);
        std::copy(color.begin(), color.end(), to + bytes_ - color.size());
      }
    }
  }

 private:
  bool has_color() const {
    return format_ == BlockFormat::kEtc2Rgb || format_ == BlockFormat::kEtc2Rgba;
  }

  void encode(const Texels& texels, std::uint64_t* block) const {
    switch (format_) {
      case BlockFormat::kEtc2Rgba:
        return CompressEtc2Rgba(texels.data(), block, 1, kEtcpakSide, true);
      case BlockFormat::kEacR11:
        return CompressEacR(texels.data(), block, 1, kEtcpakSide);
      case BlockFormat::kEacRg11:
        return CompressEacRg(texels.data(), block, 1, kEtcpakSide);
      default:
        return CompressEtc2Rgb(texels.data(), block, 1, kEtcpakSide, true);
    }
  }

  BlockFormat format_;
  int bytes_;
};

}  // namespace

std::unique_ptr<ByteEncoder> make_etcpak_encoder(const BlockOptions& options) {
  return std::make_unique<EtcpakEncoder>(options);
}

}  // namespace prefilter
