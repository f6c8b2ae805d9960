// SPDX-License-Identifier: GPL-3.0-or-later

// Contrast of UV seams in the levels of a mipmap.
#pragma once

#include <vector>

#include "prefilter/base/image.h"
#include "prefilter/base/run.h"
#include "prefilter/base/wrap.h"
#include "prefilter/geometry/surface.h"

namespace prefilter {

/// For each level: the root mean square, over the length of the seams and the channels, of the
/// difference between the bilinear lookups on both sides; 0 without seams. Throws Error if there
/// are no levels, if their channel counts differ, or if a seam reads a texel that is not finite.
std::vector<double> seam_contrast(const std::vector<ImageView>& levels,
                                  const std::vector<const Surface*>& surfaces, WrapModes wrap,
                                  const Run& run);

}  // namespace prefilter
