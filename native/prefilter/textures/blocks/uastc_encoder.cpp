// SPDX-License-Identifier: GPL-3.0-or-later

// Encodes UASTC with Basis Universal: 14 modes of ASTC that transcode quickly to BC7 and ETC.
#include <encoder/basisu_bc7enc.h>
#include <encoder/basisu_uastc_enc.h>
#include <transcoder/basisu_transcoder.h>

#include <cstddef>
#include <cstring>
#include <mutex>

#include "prefilter/textures/blocks/encoders.h"

namespace prefilter {
namespace {

constexpr std::ptrdiff_t kBlockTexelBytes = 4 * 16;
// Effort includes hints for transcoding to ETC1; the best ones double the time.
std::uint32_t flags_for(BlockEffort effort) {
  std::uint32_t level = basisu::cPackUASTCLevelDefault;
  if (effort == BlockEffort::kFast) level = basisu::cPackUASTCLevelFastest;
  if (effort == BlockEffort::kBest) level = basisu::cPackUASTCLevelSlower;
  return level | basisu::cPackUASTCETC1FasterHints;
}

/// Initializes the library's tables. Its own function for that requires OpenCL as well.
void make_tables() {
  static std::once_flag once;
  std::call_once(once, [] {
    basist::basisu_transcoder_init();
    basisu::pack_etc1_solid_color_init();
    basisu::bc7enc_compress_block_init();
  });
}

class UastcEncoder final : public ByteEncoder {
 public:
  explicit UastcEncoder(BlockEffort effort) : flags_(flags_for(effort)) { make_tables(); }

  void encode(const BlockRow<std::uint8_t>& row, std::uint8_t* blocks) override {
    for (int i = 0; i < row.count; ++i) {
      basist::uastc_block block;
      basisu::encode_uastc(row.texels + kBlockTexelBytes * i, block, flags_);
      std::memcpy(blocks + std::ptrdiff_t{sizeof block} * i, &block, sizeof block);
    }
  }

 private:
  std::uint32_t flags_;
};

}  // namespace

std::unique_ptr<ByteEncoder> make_uastc_encoder(BlockEffort effort) {
  return std::make_unique<UastcEncoder>(effort);
}

}  // namespace prefilter
