// SPDX-License-Identifier: GPL-3.0-or-later

// Finds planar faces of meshes that are wide relative to a cell.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "prefilter/voxels/contour/smooth_regions.h"

namespace prefilter {

/// For each triangle the width of its facet, which is its area divided by the diagonal of its box,
/// if the facet is planar up to 1/4 degree and wider than `least`; otherwise 0. `facets` holds the
/// facet number of each triangle. Empty if there are no such facets.
std::vector<double> wide_facets(const WeldedMeshes& welded, std::span<const std::int32_t> facets,
                                int facet_count, double least);

}  // namespace prefilter
