// SPDX-License-Identifier: GPL-3.0-or-later

// Finds regions that the outside does not reach, but whose winding number is 0.
#pragma once

#include <span>
#include <vector>

#include "prefilter/voxels/octree.h"
#include "prefilter/voxels/solid/patches.h"
#include "prefilter/voxels/solid/reach.h"
#include "prefilter/voxels/solid/triangle_sides.h"

namespace prefilter {

/// Share of each region, by label, that is inside the octree's shape; 0 for other labels.
std::vector<double> filled_shares(const ReachGrid& grid, const Octree& octree, int threads);

/// Flags the regions, by label, that are mostly bounded by open parts and not filled.
std::vector<bool> hollow_regions(const Patches& patches, std::span<const double> areas,
                                 std::span<const TriangleSides> sides,
                                 std::span<const double> filled_shares);

/// The open parts with one of the flagged regions on one side, and the outside on the other, over
/// at least half of their area.
std::vector<std::size_t> parts_around(const Patches& patches, std::span<const double> areas,
                                      std::span<const TriangleSides> sides,
                                      const std::vector<bool>& is_hollow);

}  // namespace prefilter
