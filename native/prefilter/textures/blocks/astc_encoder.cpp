// SPDX-License-Identifier: GPL-3.0-or-later

// Encodes ASTC with Arm's astcenc.
#include <cstddef>
#include <memory>
#include <new>

#include "prefilter/textures/blocks/astc_context.h"
#include "prefilter/textures/blocks/encoders.h"

namespace prefilter {
namespace {

float preset_for(BlockEffort effort) {
  if (effort == BlockEffort::kFast) return ASTCENC_PRE_FAST;
  return effort == BlockEffort::kBest ? ASTCENC_PRE_THOROUGH : ASTCENC_PRE_MEDIUM;
}

template <class Channel>
class AstcEncoder final : public BlockEncoder<Channel> {
 public:
  explicit AstcEncoder(const BlockOptions& options)
      : layout_(layout_of(options.format)),
        context_(make_astc_context(layout_, options.is_srgb, preset_for(options.effort),
                                   options.weigh_by_alpha ? ASTCENC_FLG_USE_ALPHA_WEIGHT : 0)) {}

  void encode(const BlockRow<Channel>& row, std::uint8_t* blocks) override {
    void* texels = const_cast<Channel*>(row.texels);
    astcenc_image image = astc_image<Channel>(layout_.columns, layout_.rows * row.count, &texels);
    const auto bytes = kAstcBlockBytes * static_cast<std::size_t>(row.count);
    if (astcenc_compress_image(context_.get(), &image, &kAstcChannels, blocks, bytes, 0) !=
        ASTCENC_SUCCESS) {
      throw std::bad_alloc();
    }
  }

 private:
  const BlockLayout& layout_;
  AstcContext context_;
};

}  // namespace

std::unique_ptr<ByteEncoder> make_astc_encoder(const BlockOptions& options) {
  return std::make_unique<AstcEncoder<std::uint8_t>>(options);
}

std::unique_ptr<HalfEncoder> make_astc_hdr_encoder(const BlockOptions& options) {
  return std::make_unique<AstcEncoder<HalfBits>>(options);
}

}  // namespace prefilter
