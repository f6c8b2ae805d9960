// SPDX-License-Identifier: GPL-3.0-or-later

// How much UV seams show in the levels of a mipmap.
#pragma once

#include <vector>

#include "prefilter/base/image.h"
#include "prefilter/base/progress.h"
#include "prefilter/base/wrap.h"
#include "prefilter/geometry/surface.h"

namespace prefilter {

/// The root mean square, over the length of the seams and the channels, of the difference between
/// the bilinear lookups on their two sides, level by level; 0 where there is no seam. Throws Error
/// where the levels are none, or differ in channels, or a seam reads a texel that is not finite.
std::vector<double> seam_contrast(const std::vector<ImageView>& levels,
                                  const std::vector<const Surface*>& surfaces, WrapModes wrap,
                                  const Progress& progress);

}  // namespace prefilter
