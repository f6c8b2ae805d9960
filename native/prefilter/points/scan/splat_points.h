// SPDX-License-Identifier: GPL-3.0-or-later

// Gaussian splats as points of a surface.
#pragma once

#include <memory>

#include "prefilter/points/point_source.h"

namespace prefilter {

/// The points of a source whose attributes are those of Gaussian splats (scale_0 and so on, rot_0
/// to rot_3, opacity): their centers. A splat is flat along its shortest axis, which is its normal
/// but for the direction; surfels, which have no third axis, have that one. Weights are opacities,
/// which files keep as logits, and colors are bytes of what f_dc_0 to f_dc_2 say of all directions;
/// how splats look from one direction or another (f_rest) is left out. Any other source comes back
/// as it is.
std::unique_ptr<PointSource> as_points_of_splats(std::unique_ptr<PointSource> source);

}  // namespace prefilter
