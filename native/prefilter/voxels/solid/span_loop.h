// SPDX-License-Identifier: GPL-3.0-or-later

// Triangulates a loop without adding points.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/base/run.h"
#include "prefilter/voxels/solid/hole_patch.h"

namespace prefilter {

/// A patch of about the smallest area over a loop of three points or more, all within a box of
/// about 1. For up to 400 points it is optimal, where triangles folded back onto a neighbor, or
/// onto the surface around, are penalized by twice their area. For longer loops, 400 points are
/// spanned first and the others inserted one by one. `normals` holds the unit normals of the
/// surface at the edges, from each point to the next; zero where there is none. Throws
/// Error(kCancelled).
HolePatch span_loop(std::span<const Vector3> loop, std::span<const Vector3> normals,
                    const Run& run);

/// Up to `most` points of a loop that approximate the others and are spread evenly, in order,
/// beginning with point 0.
std::vector<std::uint32_t> simplify_loop(std::span<const Vector3> loop, std::size_t most);

/// The mean unit normals of the edges between consecutive points in `kept`.
std::vector<Vector3> mean_normals(std::span<const Vector3> normals,
                                  std::span<const std::uint32_t> kept);

/// Inserts the loop's points that the border of a patch skips; the patch must hold them already as
/// unused points. Flips edges like HolePatch::flip. Throws Error(kCancelled).
void insert_points(std::span<const Vector3> loop, bool bends, HolePatch* patch, const Run& run);

}  // namespace prefilter
