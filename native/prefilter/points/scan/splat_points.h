// SPDX-License-Identifier: GPL-3.0-or-later

// Gaussian splats as surface points.
#pragma once

#include <memory>

#include "prefilter/points/point_source.h"

namespace prefilter {

/// Converts a source whose attributes describe Gaussian splats (scale_0 and so on, rot_0 to rot_3,
/// opacity) to points at their centers. The normal is a splat's shortest axis, of unknown sign; for
/// surfels, with two scales, it is the third axis. Weights are opacities, stored as logits, and
/// colors are bytes of f_dc_0 to f_dc_2, the part independent of the direction; f_rest is ignored.
/// Other sources are returned unchanged.
std::unique_ptr<PointSource> as_points_of_splats(std::unique_ptr<PointSource> source);

}  // namespace prefilter
