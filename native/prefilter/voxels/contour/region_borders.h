// SPDX-License-Identifier: GPL-3.0-or-later

// Removes small regions, and borders that are only roughness.
#pragma once

#include <cstdint>
#include <vector>

#include "prefilter/base/run.h"
#include "prefilter/voxels/contour/smooth_regions.h"
#include "prefilter/voxels/contour/source_regions.h"

namespace prefilter {

struct RegionAreas {
  std::vector<double> regions;
  std::vector<float> vertices;  // area of the triangles around each vertex
};

/// Measures regions; regions of area 0 lose their label (-1). Throws Error(kCancelled).
RegionAreas measure_regions(const WeldedMeshes& welded, int region_count, const Run& run,
                            std::vector<std::int32_t>* labels);

/// Joins regions smaller than `least` to the region of their group with the longest common walls,
/// and regions narrower than `narrow` to the one with the longest common creases.
void join_small(const WeldedMeshes& welded, const std::vector<double>& areas, double least,
                double narrow, SmoothRegions* regions);

/// Whether each connected set of edges is at least `least` cells long and no roughness, which is
/// blunt and has many vertices where edges turn, end or meet.
std::vector<std::uint8_t> are_smooth(const WeldedMeshes& welded,
                                     const std::vector<RegionBorder>& borders, double least,
                                     double cell);

/// The walls that are borders; regions divided only by other walls are joined. Edges within a
/// region count if connected edges are at least eight cells long; edges between groups, and creases
/// between regions, always count.
std::vector<RegionBorder> find_borders(const WeldedMeshes& welded, double cell,
                                       SmoothRegions* regions);

}  // namespace prefilter
