// SPDX-License-Identifier: GPL-3.0-or-later

// Occupancy octrees on other cells.
#pragma once

#include <optional>

#include "prefilter/base/progress.h"
#include "prefilter/voxels/octree.h"

namespace prefilter {

/// The same shape on the cells of another box, down to `depth`: exact where its cells are leaves or
/// made up of them, and otherwise what of them is inside of the leaves' surfaces (LeafSurface).
/// Preconditions: bounds that check_box accepts, and a depth from 0 to kMaxTreeDepth. Throws
/// Error(kCancelled).
Octree regridded(const Octree& octree, const Box& bounds, int depth, const Progress& progress,
                 int threads);

/// Whether a box lies within bounds, but for rounding.
bool holds(const Box& bounds, const Box& box);

/// An octree of a larger root, twice as wide each time, that has the same cells and holds `box` as
/// well. Throws Error where its finest cells would be deeper than kMaxTreeDepth.
Octree grown(Octree octree, const Box& box);

/// The box of the leaves that are not empty; none where all are.
std::optional<Box> occupied_box(const Octree& octree);

}  // namespace prefilter
