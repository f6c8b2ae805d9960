// The sRGB transfer curve (IEC 61966-2-1), extended to negative values by symmetry.
#pragma once

#include "prefilter/base/image.h"

namespace prefilter {

float srgb_to_linear(float encoded);
float linear_to_srgb(float linear);

/// The image with its colour channels decoded or encoded. A fourth channel is alpha and stays.
Image decode_srgb(const ImageView& image, int threads);
Image encode_srgb(const ImageView& image, int threads);

}  // namespace prefilter
