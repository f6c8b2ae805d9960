// SPDX-License-Identifier: GPL-3.0-or-later

// Section 7.3: levels by least squares over the surface.
#pragma once

#include <vector>

#include "prefilter/base/image.h"
#include "prefilter/base/progress.h"
#include "prefilter/base/solve/nine_point_system.h"
#include "prefilter/images/filters/filtered_image.h"
#include "prefilter/textures/mipmap/seam_links.h"
#include "prefilter/textures/mipmaps.h"

namespace prefilter {

/// Levels 1 to level_count - 1, of the filter in `options`, which is a fit; texels that nothing
/// reads are filled. `seams` are those that count, none where there is no budget for them, and
/// `solve` has the ranges of the channels.
std::vector<Image> fitted_levels(const FilteredImage& image,
                                 const std::vector<const Surface*>& surfaces,
                                 const std::vector<SeamEdge>& seams, const SolveOptions& solve,
                                 const MipmapOptions& options, int level_count,
                                 const Progress& progress);

}  // namespace prefilter
