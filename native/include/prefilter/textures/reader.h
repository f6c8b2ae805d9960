// SPDX-License-Identifier: GPL-3.0-or-later

// The order in which a renderer decodes and filters texels.
#pragma once

#include "prefilter/base/names.h"

namespace prefilter {

enum class Reader {
  kLinear,     // decodes texels, then filters: GPUs, and float textures everywhere
  kSrgbAfter,  // filters sRGB-encoded texels, then decodes: Cycles on 8-bit sRGB images
};

inline constexpr Named<Reader> kReaders[] = {{"linear", Reader::kLinear},
                                             {"srgb-after", Reader::kSrgbAfter}};

/// Number of channels that are stored sRGB-encoded: the colors. A fourth channel is alpha.
inline int encoded_channels(int channels) { return channels < 3 ? channels : 3; }

}  // namespace prefilter
