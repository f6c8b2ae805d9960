// SPDX-License-Identifier: GPL-3.0-or-later

// The fitting is that of Arm's encoder, astcenc.
#include <astcenc.h>

#include <cstddef>
#include <new>
#include <string>
#include <type_traits>

#include "prefilter/base/error.h"
#include "prefilter/blocks/encoders.h"

namespace prefilter {
namespace {

constexpr int kBlockBytes = 16;

struct FreeContext {
  void operator()(astcenc_context* context) const { astcenc_context_free(context); }
};
using Context = std::unique_ptr<astcenc_context, FreeContext>;

/// A context of its own: of those that share another's tables astcenc 5 takes the error that is
/// small enough for a limit in decibels, and spends two to three times as long on a block.
Context context_of(const BlockOptions& options) {
  const BlockLayout& layout = layout_of(options.format);
  astcenc_profile profile = options.is_srgb ? ASTCENC_PRF_LDR_SRGB : ASTCENC_PRF_LDR;
  if (layout.is_float) profile = ASTCENC_PRF_HDR_RGB_LDR_A;
  astcenc_config config{};
  const unsigned flags = options.weigh_by_alpha ? ASTCENC_FLG_USE_ALPHA_WEIGHT : 0;
  if (astcenc_config_init(profile, static_cast<unsigned>(layout.columns),
                          static_cast<unsigned>(layout.rows), 1, ASTCENC_PRE_MEDIUM, flags,
                          &config) != ASTCENC_SUCCESS) {
    throw_invalid("format: astcenc does not know '" + std::string(layout.name) + "'");
  }
  astcenc_context* context = nullptr;
  if (astcenc_context_alloc(&config, 1, &context, nullptr) != ASTCENC_SUCCESS) {
    throw std::bad_alloc();
  }
  return Context(context);
}

template <class Channel>
class AstcEncoder final : public BlockEncoder<Channel> {
 public:
  explicit AstcEncoder(const BlockOptions& options)
      : layout_(layout_of(options.format)), context_(context_of(options)) {}

  void encode(const BlockRow<Channel>& row, std::uint8_t* blocks) override {
    void* texels = const_cast<Channel*>(row.texels);
    astcenc_image image{
        static_cast<unsigned>(layout_.columns), static_cast<unsigned>(layout_.rows * row.count), 1,
        std::is_same_v<Channel, HalfBits> ? ASTCENC_TYPE_F16 : ASTCENC_TYPE_U8, &texels};
    const astcenc_swizzle kept{ASTCENC_SWZ_R, ASTCENC_SWZ_G, ASTCENC_SWZ_B, ASTCENC_SWZ_A};
    const auto bytes = static_cast<std::size_t>(kBlockBytes) * static_cast<std::size_t>(row.count);
    if (astcenc_compress_image(context_.get(), &image, &kept, blocks, bytes, 0) !=
        ASTCENC_SUCCESS) {
      throw std::bad_alloc();
    }
  }

 private:
  const BlockLayout& layout_;
  Context context_;
};

}  // namespace

std::unique_ptr<ByteEncoder> make_astc_encoder(const BlockOptions& options) {
  return std::make_unique<AstcEncoder<std::uint8_t>>(options);
}

std::unique_ptr<HalfEncoder> make_astc_hdr_encoder(const BlockOptions& options) {
  return std::make_unique<AstcEncoder<HalfBits>>(options);
}

}  // namespace prefilter
