// SPDX-License-Identifier: GPL-3.0-or-later

#include <cstddef>
#include <cstring>
// The header below needs std::size_t.
#include <Decode.hpp>
#include <vector>

#include "prefilter/textures/blocks/decoders.h"

namespace prefilter {
namespace {

constexpr int kEtcpakDecodedSide = 4;

class EtcpakDecoder final : public ByteDecoder {
 public:
  explicit EtcpakDecoder(const DecodeOptions& options)
      : format_(options.format), bytes_(layout_of(options.format).bytes) {}

  void decode(const std::uint8_t* blocks, int count, std::uint8_t* texels) override {
    const auto size = static_cast<std::size_t>(count);
    std::vector<std::uint64_t> words(size * static_cast<std::size_t>(bytes_) / sizeof words[0]);
    std::memcpy(words.data(), blocks, words.size() * sizeof words[0]);
    std::vector<std::uint32_t> rgba(size * kEtcpakDecodedSide * kEtcpakDecodedSide);
    decode(words.data(), rgba.data(), kEtcpakDecodedSide * count);
    std::memcpy(texels, rgba.data(), rgba.size() * sizeof rgba[0]);
  }

 private:
  void decode(const std::uint64_t* words, std::uint32_t* rgba, int width) const {
    switch (format_) {
      case BlockFormat::kEtc2Rgba:
        return DecodeRGBA(words, rgba, width, kEtcpakDecodedSide);
      case BlockFormat::kEacR11:
        return DecodeR(words, rgba, width, kEtcpakDecodedSide);
      case BlockFormat::kEacRg11:
        return DecodeRG(words, rgba, width, kEtcpakDecodedSide);
      default:
        return DecodeRGB(words, rgba, width, kEtcpakDecodedSide);
    }
  }

  BlockFormat format_;
  int bytes_;
};

}  // namespace

std::unique_ptr<ByteDecoder> make_etcpak_decoder(const DecodeOptions& options) {
  return std::make_unique<EtcpakDecoder>(options);
}

}  // namespace prefilter
