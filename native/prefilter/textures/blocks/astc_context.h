// SPDX-License-Identifier: GPL-3.0-or-later

// Contexts and images of Arm's astcenc, shared by the encoder and the decoder.
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

/// Each worker gets a context of its own. If a context shares another's tables, astcenc 5
/// interprets its error limit, already converted from decibels, as decibels again, and takes two to
/// three times as long per block. Throws std::invalid_argument if astcenc has no blocks of that
/// size.
inline AstcContext make_astc_context(const BlockLayout& layout, bool is_srgb, float effort,
                                     unsigned flags) {
  astcenc_profile profile = is_srgb ? ASTCENC_PRF_LDR_SRGB : ASTCENC_PRF_LDR;
  if (layout.is_float) profile = ASTCENC_PRF_HDR_RGB_LDR_A;
  // astcenc 5 caches the presets for a block size in a static variable without a lock.
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

/// The image whose texels `slice` points to.
template <class Channel>
astcenc_image astc_image(int width, int height, void** slice) {
  const auto type = std::is_same_v<Channel, HalfBits> ? ASTCENC_TYPE_F16 : ASTCENC_TYPE_U8;
  return {static_cast<unsigned>(width), static_cast<unsigned>(height), 1, type, slice};
}

}  // namespace prefilter
