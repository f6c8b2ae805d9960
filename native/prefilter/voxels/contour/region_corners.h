// SPDX-License-Identifier: GPL-3.0-or-later

// Where borders of regions meet, end or turn, and where regions come to a point.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "prefilter/voxels/contour/smooth_regions.h"
#include "prefilter/voxels/contour/source_regions.h"

namespace prefilter {

/// The vertices with another number of borders than two, or where two turn by more than 30 degrees.
std::vector<RegionCorner> border_corners(const FramedPositions& positions,
                                         const std::vector<RegionBorder>& borders);

/// The vertices that no wall ends at, with triangles of more than `least` area around, whose
/// normals differ much.
std::vector<RegionCorner> tips(const WeldedMeshes& welded, std::span<const std::int32_t> labels,
                               const std::vector<std::uint8_t>& is_on_wall,
                               const std::vector<float>& areas, double least);

}  // namespace prefilter
