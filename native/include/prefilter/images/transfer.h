// SPDX-License-Identifier: GPL-3.0-or-later

// The sRGB transfer curve (IEC 61966-2-1), extended to negative values by symmetry.
#pragma once

#include <cstdint>
#include <vector>

#include "prefilter/base/image.h"

namespace prefilter {

float srgb_to_linear(float encoded);
float linear_to_srgb(float linear);

/// The image with its color channels decoded or encoded. A fourth channel is alpha and stays.
Image decode_srgb(const ImageView& image, int threads);
Image encode_srgb(const ImageView& image, int threads);

/// What bytes stand for: a 255th each, and for the color channels of an image with `srgb` what
/// that is decoded. A fourth channel is alpha.
ByteValues byte_values(bool srgb);

/// The image as such bytes, to the nearest; values beyond [0, 1] become 0 or 255.
std::vector<std::uint8_t> to_bytes(const ImageView& image, bool srgb, int threads);

}  // namespace prefilter
