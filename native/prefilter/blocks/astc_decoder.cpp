// SPDX-License-Identifier: GPL-3.0-or-later

#include <astcenc.h>

#include <cstddef>
#include <new>
#include <string>
#include <type_traits>

#include "prefilter/base/error.h"
#include "prefilter/blocks/decoders.h"

namespace prefilter {
namespace {

constexpr std::size_t kBlockBytes = 16;

struct FreeContext {
  void operator()(astcenc_context* context) const { astcenc_context_free(context); }
};
using Context = std::unique_ptr<astcenc_context, FreeContext>;

Context context_of(const DecodeOptions& options) {
  const BlockLayout& layout = layout_of(options.format);
  astcenc_profile profile = options.is_srgb ? ASTCENC_PRF_LDR_SRGB : ASTCENC_PRF_LDR;
  if (layout.is_float) profile = ASTCENC_PRF_HDR_RGB_LDR_A;
  astcenc_config config{};
  if (astcenc_config_init(profile, static_cast<unsigned>(layout.columns),
                          static_cast<unsigned>(layout.rows), 1, ASTCENC_PRE_FASTEST,
                          ASTCENC_FLG_DECOMPRESS_ONLY, &config) != ASTCENC_SUCCESS) {
    throw_invalid("format: astcenc does not know '" + std::string(layout.name) + "'");
  }
  astcenc_context* context = nullptr;
  if (astcenc_context_alloc(&config, 1, &context, nullptr) != ASTCENC_SUCCESS) {
    throw std::bad_alloc();
  }
  return Context(context);
}

template <class Channel>
class AstcDecoder final : public BlockDecoder<Channel> {
 public:
  explicit AstcDecoder(const DecodeOptions& options)
      : layout_(layout_of(options.format)), context_(context_of(options)) {}

  void decode(const std::uint8_t* blocks, int count, Channel* texels) override {
    void* slice = texels;
    astcenc_image image{
        static_cast<unsigned>(layout_.columns * count), static_cast<unsigned>(layout_.rows), 1,
        std::is_same_v<Channel, HalfBits> ? ASTCENC_TYPE_F16 : ASTCENC_TYPE_U8, &slice};
    const astcenc_swizzle kept{ASTCENC_SWZ_R, ASTCENC_SWZ_G, ASTCENC_SWZ_B, ASTCENC_SWZ_A};
    astcenc_decompress_reset(context_.get());
    if (astcenc_decompress_image(context_.get(), blocks,
                                 kBlockBytes * static_cast<std::size_t>(count), &image, &kept,
                                 0) != ASTCENC_SUCCESS) {
      throw std::bad_alloc();
    }
  }

 private:
  const BlockLayout& layout_;
  Context context_;
};

}  // namespace

std::unique_ptr<ByteDecoder> make_astc_decoder(const DecodeOptions& options) {
  return std::make_unique<AstcDecoder<std::uint8_t>>(options);
}

std::unique_ptr<HalfDecoder> make_astc_hdr_decoder(const DecodeOptions& options) {
  return std::make_unique<AstcDecoder<HalfBits>>(options);
}

}  // namespace prefilter
