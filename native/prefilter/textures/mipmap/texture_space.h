// SPDX-License-Identifier: GPL-3.0-or-later

// Levels by filters in texture space, which know nothing of the surface but, at most, which texels
// it touches. They are what parameterization-aware levels are compared with.
#pragma once

#include <vector>

#include "prefilter/base/image.h"
#include "prefilter/base/progress.h"
#include "prefilter/base/wrap.h"
#include "prefilter/images/kernel.h"

namespace prefilter {

/// One level, filtered from the full-size image with the kernel scaled to the level's texels.
Image filter_level(const ImageView& image, int level, const Kernel& kernel, WrapModes wrap,
                   const Progress& progress, int threads);

/// The same over covered texels alone, renormalized: filter(image * covered) / filter(covered). A
/// texel with no covered texel in its square is filled by push-pull. Where a kernel with negative
/// lobes leaves less than a tenth of the weight, the box over the texel's square takes its place.
/// Uncovered texels are not read, and may be anything. `covered` has 0 or 1 a texel.
Image filter_covered_level(const ImageView& image, const std::vector<unsigned char>& covered,
                           int level, const Kernel& kernel, WrapModes wrap,
                           const Progress& progress, int threads);

}  // namespace prefilter
