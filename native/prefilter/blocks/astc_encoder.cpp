// The fitting is that of Arm's encoder, astcenc.
#include <astcenc.h>

#include <cstddef>
#include <new>
#include <string>
#include <type_traits>
#include <utility>

#include "prefilter/base/error.h"
#include "prefilter/blocks/encoders.h"

namespace prefilter {
namespace {

constexpr int kBlockBytes = 16;

struct FreeContext {
  void operator()(astcenc_context* context) const { astcenc_context_free(context); }
};
using Context = std::unique_ptr<astcenc_context, FreeContext>;

Context allocated(const astcenc_config* config, const astcenc_context* parent) {
  astcenc_context* context = nullptr;
  if (astcenc_context_alloc(config, 1, &context, parent) != ASTCENC_SUCCESS) throw std::bad_alloc();
  return Context(context);
}

Context tables_of(const BlockOptions& options) {
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
  return allocated(&config, nullptr);
}

template <class Channel>
class AstcEncoder final : public BlockEncoder<Channel> {
 public:
  AstcEncoder(const BlockOptions& options, std::shared_ptr<astcenc_context> tables)
      : layout_(layout_of(options.format)),
        tables_(std::move(tables)),
        context_(allocated(nullptr, tables_.get())) {}

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
  std::shared_ptr<astcenc_context> tables_;
  Context context_;
};

}  // namespace

template <class Channel>
EncoderMaker<Channel> astc_encoders(const BlockOptions& options) {
  const std::shared_ptr<astcenc_context> tables = tables_of(options);
  return [options, tables] { return std::make_unique<AstcEncoder<Channel>>(options, tables); };
}

template EncoderMaker<std::uint8_t> astc_encoders(const BlockOptions&);
template EncoderMaker<HalfBits> astc_encoders(const BlockOptions&);

}  // namespace prefilter
