// SPDX-License-Identifier: GPL-3.0-or-later

// Plane faces of meshes that are wide beside a cell.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "prefilter/contour/smooth_regions.h"

namespace prefilter {

/// For each triangle whether it is of a facet that is plane, up to a quarter of a degree, and wider
/// than `least`: its area over the diagonal of its box. `facets` are the numbers of the triangles'
/// facets. Empty where none is.
std::vector<std::uint8_t> of_wide_facets(const WeldedMeshes& welded,
                                         std::span<const std::int32_t> facets, int facet_count,
                                         double least);

}  // namespace prefilter
