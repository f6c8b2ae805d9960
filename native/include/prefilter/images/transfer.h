// SPDX-License-Identifier: GPL-3.0-or-later

// The sRGB transfer curve (IEC 61966-2-1), extended to negative values by symmetry.
#pragma once

#include <cstdint>
#include <vector>

#include "prefilter/base/image.h"

namespace prefilter {

float srgb_to_linear(float encoded);
float linear_to_srgb(float linear);

/// Decodes or encodes the color channels of an image. A fourth channel is alpha and does not
/// change.
Image decode_srgb(const ImageView& image, int threads);
Image encode_srgb(const ImageView& image, int threads);

/// The values of the 256 bytes: multiples of 1/255, decoded for the color channels if `srgb`. A
/// fourth channel is alpha.
ByteValues byte_values(bool srgb);

/// Converts an image to such bytes, rounded to the nearest; values outside [0, 1] become 0 or 255.
std::vector<std::uint8_t> to_bytes(const ImageView& image, bool srgb, int threads);

}  // namespace prefilter
