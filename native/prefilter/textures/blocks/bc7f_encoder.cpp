// SPDX-License-Identifier: GPL-3.0-or-later

// BC7F of Basis Universal chooses modes by errors predicted from covariances and, with more effort,
// by actual errors.
#include <basisu_transcoder.h>

#include <array>
#include <cstddef>
#include <cstring>
#include <mutex>

#include "prefilter/textures/blocks/encoders.h"

namespace prefilter {
namespace {

constexpr std::size_t kBc7fTexels = 16;
constexpr std::ptrdiff_t kBc7fTexelBytes = 4 * kBc7fTexels;
constexpr std::ptrdiff_t kBc7fBlockBytes = 16;

// Without the option that may make opaque texels of mode 6 transparent.
constexpr std::uint32_t kFast =
    basist::bc7f::cPackBC7FlagDefault & ~std::uint32_t{basist::bc7f::cPackBC7FlagPBitOptMode6};
constexpr std::uint32_t kThorough = basist::bc7f::cPackBC7FlagDefaultNonAnalytical &
                                    ~std::uint32_t{basist::bc7f::cPackBC7FlagPBitOptMode6};

class Bc7fEncoder final : public ByteEncoder {
 public:
  explicit Bc7fEncoder(BlockEffort effort)
      : flags_(effort == BlockEffort::kFast ? kFast : kThorough) {
    static std::once_flag once;
    std::call_once(once, [] {
      // Initializes, among others, the table of single-color blocks.
      basist::uastc_init();
      basist::bc7f::init();
    });
  }

  void encode(const BlockRow<std::uint8_t>& row, std::uint8_t* blocks) override {
    std::array<basist::color_rgba, kBc7fTexels> texels;
    for (int i = 0; i < row.count; ++i) {
      std::memcpy(texels.data(), row.texels + kBc7fTexelBytes * i, kBc7fTexelBytes);
      basist::bc7f::fast_pack_bc7_auto_rgba(blocks + kBc7fBlockBytes * i, texels.data(), flags_);
    }
  }

 private:
  std::uint32_t flags_;
};

}  // namespace

std::unique_ptr<ByteEncoder> make_bc7f_encoder(BlockEffort effort) {
  return std::make_unique<Bc7fEncoder>(effort);
}

}  // namespace prefilter
