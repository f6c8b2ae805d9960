// SPDX-License-Identifier: GPL-3.0-or-later

// Finds the self-intersections of a mesh.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/base/run.h"

namespace prefilter {

/// Returns the pairs of triangles that intersect (cross, overlap or touch) beyond the vertices and
/// edges that they share by index. Each pair appears once, the lower index first, in ascending
/// order. Triangles of zero area are ignored, since they have no sides.
///
/// Decided by exact predicates; the result does not depend on the number of threads. Throws Error
/// for an invalid mesh, or one of 2^31 vertices or more; Error(kCancelled).
std::vector<std::array<std::uint32_t, 2>> self_intersections(const InputMesh& mesh, const Run& run);

}  // namespace prefilter
