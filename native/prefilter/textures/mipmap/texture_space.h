// SPDX-License-Identifier: GPL-3.0-or-later

// Filters in texture space. They ignore the surface, except possibly to skip texels it does not
// touch; the parameterization-aware levels are compared with them.
#pragma once

#include <vector>

#include "prefilter/base/image.h"
#include "prefilter/base/run.h"
#include "prefilter/base/wrap.h"
#include "prefilter/images/kernel.h"

namespace prefilter {

/// Filters one level from the full-size image, with the kernel scaled to the level's texels.
Image filter_level(const ImageView& image, int level, const Kernel& kernel, WrapModes wrap,
                   const Run& run);

/// The same over covered texels only, renormalized: filter(image * covered) / filter(covered).
/// Texels without a covered texel in their square are filled by push-pull. If a kernel with
/// negative lobes leaves less than a tenth of the weight, the box over the texel's square is used
/// instead. Uncovered texels are not read. `covered` is 0 or 1 per texel.
Image filter_covered_level(const ImageView& image, const std::vector<unsigned char>& covered,
                           int level, const Kernel& kernel, WrapModes wrap, const Run& run);

}  // namespace prefilter
