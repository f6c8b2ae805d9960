// SPDX-License-Identifier: GPL-3.0-or-later

// Section 7.3: levels fitted to lookups over the surface by least squares.
#pragma once

#include <vector>

#include "prefilter/base/image.h"
#include "prefilter/base/run.h"
#include "prefilter/base/solve/nine_point_system.h"
#include "prefilter/images/filters/filtered_image.h"
#include "prefilter/textures/mipmap/seam_links.h"
#include "prefilter/textures/mipmaps.h"

namespace prefilter {

/// Computes levels 1 to level_count - 1 with the fit in `options`; texels that no lookup reads are
/// filled. `seams` are the seams to hide, none without a budget, and `solve` has the ranges of the
/// channels.
std::vector<Image> fitted_levels(const FilteredImage& image,
                                 const std::vector<const Surface*>& surfaces,
                                 const std::vector<SeamEdge>& seams, const SolveOptions& solve,
                                 const MipmapOptions& options, int level_count, const Run& run);

}  // namespace prefilter
