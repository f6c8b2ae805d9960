// SPDX-License-Identifier: GPL-3.0-or-later

#include <cstddef>
#include <memory>
#include <new>

#include "prefilter/textures/blocks/astc_context.h"
#include "prefilter/textures/blocks/decoders.h"

namespace prefilter {
namespace {

template <class Channel>
class AstcDecoder final : public BlockDecoder<Channel> {
 public:
  explicit AstcDecoder(const DecodeOptions& options)
      : layout_(layout_of(options.format)),
        context_(make_astc_context(layout_, options.is_srgb, ASTCENC_PRE_FASTEST,
                                   ASTCENC_FLG_DECOMPRESS_ONLY)) {}

  void decode(const std::uint8_t* blocks, int count, Channel* texels) override {
    void* slice = texels;
    astcenc_image image = astc_image<Channel>(layout_.columns * count, layout_.rows, &slice);
    astcenc_decompress_reset(context_.get());
    if (astcenc_decompress_image(context_.get(), blocks,
                                 kAstcBlockBytes * static_cast<std::size_t>(count), &image,
                                 &kAstcChannels, 0) != ASTCENC_SUCCESS) {
      throw std::bad_alloc();
    }
  }

 private:
  const BlockLayout& layout_;
  AstcContext context_;
};

}  // namespace

std::unique_ptr<ByteDecoder> make_astc_decoder(const DecodeOptions& options) {
  return std::make_unique<AstcDecoder<std::uint8_t>>(options);
}

std::unique_ptr<HalfDecoder> make_astc_hdr_decoder(const DecodeOptions& options) {
  return std::make_unique<AstcDecoder<HalfBits>>(options);
}

}  // namespace prefilter
