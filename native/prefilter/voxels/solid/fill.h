// SPDX-License-Identifier: GPL-3.0-or-later

// Surfaces of what the outside does not reach.
#pragma once

#include <cstdint>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/base/progress.h"
#include "prefilter/voxels/solid/reach.h"

namespace prefilter {

/// The closed surface of some regions of a grid: in cells with triangles that have such a region on
/// one side only, along the mean plane of these. `is_filled` has an entry for each label.
TriangleMesh filled_regions(const MeshView<std::int32_t>& mesh, const ReachGrid& grid,
                            const std::vector<bool>& is_filled, const Progress& progress,
                            int threads);

}  // namespace prefilter
