// SPDX-License-Identifier: GPL-3.0-or-later

// Regions that are large enough, and their borders that are no roughness.
#pragma once

#include <cstdint>
#include <vector>

#include "prefilter/base/progress.h"
#include "prefilter/voxels/contour/smooth_regions.h"
#include "prefilter/voxels/contour/source_regions.h"

namespace prefilter {

struct RegionAreas {
  std::vector<double> regions;
  std::vector<float> vertices;  // of the triangles around each
};

/// Regions of no area have no label from then on: -1. Throws Error(kCancelled).
RegionAreas measure_regions(const WeldedMeshes& welded, int region_count, const Progress& progress,
                            std::vector<std::int32_t>* labels);

/// Regions smaller than `least` join the one of their group with which they share the longest
/// walls; those that are narrower than `narrow`, the one with which they share the longest creases.
void join_small(const WeldedMeshes& welded, const std::vector<double>& areas, double least,
                double narrow, SmoothRegions* regions);

/// Of edges that hang together: whether they are `least` cells long, and no roughness: blunt, and
/// with many vertices where they turn, end or meet.
std::vector<std::uint8_t> are_smooth(const WeldedMeshes& welded,
                                     const std::vector<RegionBorder>& borders, double least,
                                     double cell);

/// The walls that are borders; regions that only others divide join. Edges within a region count
/// where those that hang together are eight cells long, and between groups always, as do creases
/// between regions.
std::vector<RegionBorder> find_borders(const WeldedMeshes& welded, double cell,
                                       SmoothRegions* regions);

}  // namespace prefilter
