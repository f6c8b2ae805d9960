// SPDX-License-Identifier: GPL-3.0-or-later

// Set operations on occupancy octrees (section 3.1).
#pragma once

#include "prefilter/base/names.h"
#include "prefilter/base/progress.h"
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

/// The operation cell by cell, in memory proportional to the surfaces. Octrees may be of any depths
/// and bounds.
///
/// Where depths differ, surfaces in larger cells are refined first, down to the finest cells of
/// both, in which the result has its surface: it takes the memory of octrees of that depth.
///
/// Where bounds differ, b is regridded on the cells of a, down to the first depth at which they are
/// no larger than b's, or to a's if that is deeper; for a union the root of a is doubled until it
/// holds all of b that is not empty. Throws Error where that would be deeper than kMaxTreeDepth;
/// Error(kCancelled).
///
/// Where both surfaces run through a cell and the result would be 1/2, where contours are, it is
/// rounded so that faces that coincide leave neither a film of matter (difference, intersection)
/// nor a crack (union).
Octree combine(const Octree& a, const Octree& b, SetOperation operation, const Progress& progress,
               int threads);

}  // namespace prefilter
