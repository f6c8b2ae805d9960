// SPDX-License-Identifier: GPL-3.0-or-later

// Plane faces of meshes that are wide beside a cell.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "prefilter/voxels/contour/smooth_regions.h"

namespace prefilter {

/// For each triangle the width of its facet, its area over the diagonal of its box, where that is
/// plane, up to a quarter of a degree, and wider than `least`; 0 elsewhere. `facets` are the
/// numbers of the triangles' facets. Empty where none is.
std::vector<double> wide_facets(const WeldedMeshes& welded, std::span<const std::int32_t> facets,
                                int facet_count, double least);

}  // namespace prefilter
