// SPDX-License-Identifier: GPL-3.0-or-later

// Contours the regions that the outside does not reach.
#pragma once

#include <cstdint>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/base/run.h"
#include "prefilter/voxels/solid/reach.h"

namespace prefilter {

/// Closed surface of some regions of a grid. In cells with triangles that have such a region on one
/// side only, it follows their mean plane. `is_filled` has one entry per label.
TriangleMesh filled_regions(const MeshView<std::int32_t>& mesh, const ReachGrid& grid,
                            const std::vector<bool>& is_filled, const Run& run);

}  // namespace prefilter
