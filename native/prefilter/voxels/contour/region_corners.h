// SPDX-License-Identifier: GPL-3.0-or-later

// Finds where borders of regions meet, end or turn, and where regions have tips.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "prefilter/voxels/contour/smooth_regions.h"
#include "prefilter/voxels/contour/source_regions.h"

namespace prefilter {

/// Vertices where the number of borders is not two, or two borders turn by more than 30 degrees.
std::vector<RegionCorner> border_corners(const FramedPositions& positions,
                                         const std::vector<RegionBorder>& borders);

/// Vertices that are not on walls, have triangles of more than `least` area around, and very
/// different normals.
std::vector<RegionCorner> tips(const WeldedMeshes& welded, std::span<const std::int32_t> labels,
                               const std::vector<std::uint8_t>& is_on_wall,
                               const std::vector<float>& areas, double least);

}  // namespace prefilter
