// SPDX-License-Identifier: GPL-3.0-or-later

// Set operations on occupancy octrees (section 3.1).
#pragma once

#include "prefilter/base/names.h"
#include "prefilter/base/run.h"
#include "prefilter/voxels/octree.h"

namespace prefilter {

enum class SetOperation {
  kUnion,         // max(a, b)
  kIntersection,  // min(a, b)
  kDifference,    // min(a, 1 - b)
};

inline constexpr Named<SetOperation> kSetOperations[] = {
    {"union", SetOperation::kUnion},
    {"intersection", SetOperation::kIntersection},
    {"difference", SetOperation::kDifference}};

/// Combines two octrees cell by cell, in memory proportional to their surfaces. They may differ in
/// depth and bounds.
///
/// If depths differ, cells with surface are refined to the finest depth of both, at which the
/// result has its surface; its size is that of octrees of that depth.
///
/// If bounds differ, b is resampled to the cells of a, refined to the first depth at which they are
/// no larger than b's, or to a's depth if that is greater. For a union, the root of a is doubled
/// until it contains all nonempty cells of b. Throws Error where that would exceed kMaxTreeDepth;
/// Error(kCancelled).
///
/// Where both surfaces pass through a cell and the result would be 1/2, the contour's iso-value, it
/// is rounded so that coincident faces leave neither a thin film (difference, intersection) nor a
/// crack (union).
Octree combine(const Octree& a, const Octree& b, SetOperation operation, const Run& run);

}  // namespace prefilter
