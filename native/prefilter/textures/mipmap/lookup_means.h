// SPDX-License-Identifier: GPL-3.0-or-later

// What the texels of a normal map and a roughness map show on average, for readers that
// interpolate.
#pragma once

#include "prefilter/base/image.h"
#include "prefilter/base/progress.h"
#include "prefilter/base/wrap.h"

namespace prefilter {

/// The means over each texel's square of what bilinear lookups of both maps give: the unit normal
/// less (0, 0, 1), and roughness^4, which is the alpha^2 of a microfacet distribution.
///
/// Lookups are at the points of a Gauss rule of 2 x 2 in each quarter of a texel, which is exact
/// for second moments of what is interpolated. A normal that is shorter than `least_length` counts
/// as (0, 0, 1). Throws Error where `normals` has not 3 channels, `roughness` not one, or their
/// sizes differ; and, from the progress callback, when cancelled.
Image lookup_means(const ImageView& normals, const ImageView& roughness, WrapModes wrap,
                   float least_length, const Progress& progress, int threads);

}  // namespace prefilter
