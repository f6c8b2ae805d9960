// SPDX-License-Identifier: GPL-3.0-or-later

// Regions that the outside does not reach, and that winding numbers leave empty.
#pragma once

#include <span>
#include <vector>

#include "prefilter/voxels/octree.h"
#include "prefilter/voxels/solid/patches.h"
#include "prefilter/voxels/solid/reach.h"
#include "prefilter/voxels/solid/triangle_sides.h"

namespace prefilter {

/// The share of each region, by its label, that is inside; 0 for other labels.
std::vector<double> filled_shares(const ReachGrid& grid, const Octree& octree, int threads);

/// Which regions, by label, are bounded by open parts for the most, and not filled all the same.
std::vector<bool> hollow_regions(const Patches& patches, std::span<const double> areas,
                                 std::span<const TriangleSides> sides,
                                 std::span<const double> filled_shares);

/// The open parts that have one of these regions on one side of at least half of their area, and
/// the outside on the other.
std::vector<std::size_t> parts_around(const Patches& patches, std::span<const double> areas,
                                      std::span<const TriangleSides> sides,
                                      const std::vector<bool>& is_hollow);

}  // namespace prefilter
