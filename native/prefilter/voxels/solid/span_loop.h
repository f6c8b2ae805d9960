// SPDX-License-Identifier: GPL-3.0-or-later

// Triangles over a loop that need no other points.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/base/progress.h"
#include "prefilter/voxels/solid/hole_patch.h"

namespace prefilter {

/// A patch of about the smallest area over a loop of three points and more, all within a box of
/// about 1. Of loops of up to 400 points it is the smallest but for one thing: what lies folded
/// back onto its neighbor, or onto the surface around, counts twice more. Longer ones are spanned
/// between 400 of their points first, and the others put in one by one. `normals`: the unit normals
/// of the surface at each edge, from a point to the next; zero where there is none. Throws
/// Error(kCancelled).
HolePatch span_loop(std::span<const Vector3> loop, std::span<const Vector3> normals,
                    const Progress& progress);

/// Up to `most` points of a loop that are close to all others, and not far from each other, in
/// order; the first is point 0.
std::vector<std::uint32_t> outline(std::span<const Vector3> loop, std::size_t most);

/// The unit normals of the edges between such points.
std::vector<Vector3> mean_normals(std::span<const Vector3> normals,
                                  std::span<const std::uint32_t> kept);

/// Puts the points into a patch that its border leaves out; the patch has them already, but no
/// triangle does. Flips as HolePatch::flip does. Throws Error(kCancelled).
void put_in(std::span<const Vector3> loop, bool bends, HolePatch* patch, const Progress& progress);

}  // namespace prefilter
