// SPDX-License-Identifier: GPL-3.0-or-later

// Finds intersecting triangles of a mesh.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/base/run.h"

namespace prefilter {

/// Pairs of triangles, at least one of them suspect, that intersect (cross, overlap or touch)
/// beyond the vertices and edges that they share. Vertices are shared by index, so distinct
/// vertices at equal positions count as touching. A triangle with collinear corners pairs with
/// itself, and with no other. Without flags, all triangles are suspect.
///
/// Decided without rounding errors, except that coordinates below 1e-90 times the largest may count
/// as 0. Each pair appears once, the lower index first, sorted; the result does not depend on the
/// number of threads. Time is proportional to the number of triangles and of pairs whose boxes
/// overlap. Indices must be valid and coordinates finite. Throws Error(kCancelled).
std::vector<std::array<std::uint32_t, 2>> intersecting_triangles(
    const MeshView<std::int32_t>& mesh, std::span<const std::uint8_t> is_suspect, const Run& run);

}  // namespace prefilter
