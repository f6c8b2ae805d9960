// SPDX-License-Identifier: GPL-3.0-or-later

// Where a mesh intersects itself.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/base/progress.h"

namespace prefilter {

/// The pairs of triangles that have more points in common than the vertices and edges that they
/// share by index: those that cross, overlap or touch. Each pair once, the lower index first, in
/// order. Triangles without area are left out: they have no side that could cross another.
///
/// Decided by exact predicates; the same for any number of threads. Throws Error for a mesh that is
/// no mesh, or one of 2^31 vertices or more; Error(kCancelled).
std::vector<std::array<std::uint32_t, 2>> self_intersections(const InputMesh& mesh,
                                                             const Progress& progress, int threads);

}  // namespace prefilter
