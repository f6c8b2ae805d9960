// SPDX-License-Identifier: GPL-3.0-or-later

// How much of a surface lies in each texel.
#pragma once

#include <vector>

#include "prefilter/base/image.h"
#include "prefilter/base/progress.h"
#include "prefilter/textures/texels/texel_triangles.h"

namespace prefilter {

/// The surface's mass in each texel's square, row by row; exactly 0 where no triangle is.
std::vector<float> texel_masses(const TexelTriangles& triangles, const Progress& progress,
                                int threads);

/// The surface's mass in the cells between lines along both axes, row by row; whole numbers from 0
/// to the image's sides are among the lines.
std::vector<float> cell_masses(const TexelTriangles& triangles, const std::vector<double>& x_lines,
                               const std::vector<double>& y_lines, const Progress& progress,
                               int threads);

/// 1 for each texel that any triangle touches, whatever its area, else 0.
std::vector<unsigned char> touched_texels(const std::vector<const Surface*>& surfaces, int width,
                                          int height, WrapModes wrap, const Progress& progress,
                                          int threads);

/// 1 for each texel that a bilinear lookup anywhere on the surface reads, else 0: touched ones and
/// those beside them whose tent reaches the surface.
std::vector<unsigned char> looked_up_texels(const std::vector<const Surface*>& surfaces, int width,
                                            int height, WrapModes wrap, const Progress& progress,
                                            int threads);

}  // namespace prefilter
