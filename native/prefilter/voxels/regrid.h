// SPDX-License-Identifier: GPL-3.0-or-later

// Resamples occupancy octrees to other cells.
#pragma once

#include <optional>

#include "prefilter/base/run.h"
#include "prefilter/voxels/octree.h"

namespace prefilter {

/// The same shape in the cells of another box, down to `depth`. Exact where its cells are leaves of
/// the source or unions of them; otherwise computed from the leaves' surfaces (LeafSurface).
/// Preconditions: bounds that check_box accepts, and a depth from 0 to kMaxTreeDepth. Throws
/// Error(kCancelled).
Octree regridded(const Octree& octree, const Box& bounds, int depth, const Run& run);

/// Whether a box lies within bounds, up to rounding.
bool holds(const Box& bounds, const Box& box);

/// Doubles the root, keeping the cells, until it contains `box`. Throws Error if the finest cells
/// would be deeper than kMaxTreeDepth.
Octree grown(Octree octree, const Box& box);

/// Bounding box of the nonempty leaves; none if all are empty.
std::optional<Box> occupied_box(const Octree& octree);

}  // namespace prefilter
