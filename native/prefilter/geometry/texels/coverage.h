// SPDX-License-Identifier: GPL-3.0-or-later

// Amount of surface in each texel.
#pragma once

#include <vector>

#include "prefilter/base/image.h"
#include "prefilter/base/run.h"
#include "prefilter/geometry/texels/texel_triangles.h"

namespace prefilter {

/// The surface's mass in each texel's square, in row-major order; exactly 0 where no triangle is.
std::vector<float> texel_masses(const TexelTriangles& triangles, const Run& run);

/// The surface's mass in the cells between the given lines along both axes, in row-major order. The
/// lines must include all whole numbers from 0 to the sides of the image.
std::vector<float> cell_masses(const TexelTriangles& triangles, const std::vector<double>& x_lines,
                               const std::vector<double>& y_lines, const Run& run);

/// 1 for each texel that a triangle touches, even one without area, else 0.
std::vector<unsigned char> touched_texels(const std::vector<const Surface*>& surfaces, int width,
                                          int height, WrapModes wrap, const Run& run);

/// 1 for each texel that a bilinear lookup somewhere on the surface reads, else 0: the touched
/// texels, and neighbors whose tent reaches the surface.
std::vector<unsigned char> looked_up_texels(const std::vector<const Surface*>& surfaces, int width,
                                            int height, WrapModes wrap, const Run& run);

}  // namespace prefilter
