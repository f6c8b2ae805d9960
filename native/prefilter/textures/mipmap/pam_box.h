// SPDX-License-Identifier: GPL-3.0-or-later

// Means of an image over the surface in each texel (equation 7.1 with a box).
#pragma once

#include <vector>

#include "prefilter/base/image.h"
#include "prefilter/base/run.h"
#include "prefilter/base/wrap.h"
#include "prefilter/geometry/texels/texel_triangles.h"

namespace prefilter {

/// Computes levels 1 to level_count - 1. The texels of the image are boxes too, so a uniform
/// parameterization yields the plain box filter. Texels without surface are filled by push-pull.
std::vector<Image> pam_box_levels(const TexelSource& image, const TexelTriangles& triangles,
                                  int level_count, WrapModes wrap, const Run& run);

}  // namespace prefilter
