// SPDX-License-Identifier: GPL-3.0-or-later

// What encoding and decoding by Arm's astcenc have in common.
#pragma once

#include <astcenc.h>

#include <cstddef>
#include <memory>
#include <mutex>
#include <new>
#include <string>
#include <type_traits>

#include "prefilter/base/error.h"
#include "prefilter/textures/block_layout.h"
#include "prefilter/textures/compress_blocks.h"

namespace prefilter {

inline constexpr std::size_t kAstcBlockBytes = 16;
inline constexpr astcenc_swizzle kAstcChannels{ASTCENC_SWZ_R, ASTCENC_SWZ_G, ASTCENC_SWZ_B,
                                               ASTCENC_SWZ_A};

struct FreeAstcContext {
  void operator()(astcenc_context* context) const { astcenc_context_free(context); }
};
using AstcContext = std::unique_ptr<astcenc_context, FreeAstcContext>;

/// A context of its own: of those that share another's tables astcenc 5 takes the error that is
/// small enough for a limit in decibels, and spends two to three times as long on a block.
/// Throws std::invalid_argument if astcenc has no blocks of that size.
inline AstcContext make_astc_context(const BlockLayout& layout, bool is_srgb, float effort,
                                     unsigned flags) {
  astcenc_profile profile = is_srgb ? ASTCENC_PRF_LDR_SRGB : ASTCENC_PRF_LDR;
  if (layout.is_float) profile = ASTCENC_PRF_HDR_RGB_LDR_A;
  // astcenc 5 keeps the presets for a size of blocks in a static variable while it reads them.
  static std::mutex presets;
  astcenc_config config{};
  {
    const std::lock_guard lock(presets);
    if (astcenc_config_init(profile, static_cast<unsigned>(layout.columns),
                            static_cast<unsigned>(layout.rows), 1, effort, flags,
                            &config) != ASTCENC_SUCCESS) {
      throw_invalid("format: astcenc does not know '" + std::string(layout.name) + "'");
    }
  }
  astcenc_context* context = nullptr;
  if (astcenc_context_alloc(&config, 1, &context, nullptr) != ASTCENC_SUCCESS) {
    throw std::bad_alloc();
  }
  return AstcContext(context);
}

/// The image of the texels that `slice` points to.
template <class Channel>
astcenc_image astc_image(int width, int height, void** slice) {
  const auto type = std::is_same_v<Channel, HalfBits> ? ASTCENC_TYPE_F16 : ASTCENC_TYPE_U8;
  return {static_cast<unsigned>(width), static_cast<unsigned>(height), 1, type, slice};
}

}  // namespace prefilter
