// SPDX-License-Identifier: GPL-3.0-or-later

// Where a mesh meets itself.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/base/progress.h"

namespace prefilter {

/// The pairs of triangles, one of them or both suspect, that have more points in common than the
/// vertices and edges that they share: those that cross, overlap or touch. Vertices are shared by
/// index, so that those at equal positions touch. A triangle whose corners are on one line makes a
/// pair with itself, and with no other one. No suspects: all are.
///
/// Decided without rounding errors; only coordinates smaller than 1e-90 times the largest one may
/// count as 0. Each pair once, the lower index first, in order of the indices; the same for any
/// number of threads. Time is proportional to the triangles and the pairs whose boxes meet.
/// Indices must name vertices, and coordinates be finite. Throws Error(kCancelled).
std::vector<std::array<std::uint32_t, 2>> intersecting_triangles(
    const MeshView<std::int32_t>& mesh, std::span<const std::uint8_t> is_suspect,
    const Progress& progress, int threads);

}  // namespace prefilter
