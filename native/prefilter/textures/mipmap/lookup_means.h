// SPDX-License-Identifier: GPL-3.0-or-later

// Mean of the bilinear lookups in each texel of a normal map and a roughness map.
#pragma once

#include "prefilter/base/image.h"
#include "prefilter/base/run.h"
#include "prefilter/base/wrap.h"

namespace prefilter {

/// Averages, over each texel's square, functions of bilinear lookups of both maps: the unit normal
/// minus (0, 0, 1), and roughness^4, the alpha^2 of a microfacet distribution.
///
/// Uses a Gauss rule of 2 x 2 points in each quarter of a texel, which is exact for second moments
/// of the interpolated values. Normals shorter than `least_length` count as (0, 0, 1). Throws Error
/// if `normals` does not have 3 channels, `roughness` not one, or their sizes differ; and, from the
/// progress callback, when cancelled.
Image lookup_means(const ImageView& normals, const ImageView& roughness, WrapModes wrap,
                   float least_length, const Run& run);

}  // namespace prefilter
