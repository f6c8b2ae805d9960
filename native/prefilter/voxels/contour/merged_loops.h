// SPDX-License-Identifier: GPL-3.0-or-later

// Sharp loops that share a vertex.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "prefilter/voxels/contour/feature_places.h"
#include "prefilter/voxels/contour/linked_loops.h"
#include "prefilter/voxels/contour/loop_triangles.h"

namespace prefilter {

/// For each loop the first loop with the same vertex: joined loops share one if their features are
/// closer than 1/20 of a cell, unless they must stay single.
std::vector<std::size_t> merged_loops(const LinkedLoops& loops, std::span<const Feature> features,
                                      std::span<const std::uint8_t> is_sharp,
                                      std::span<const std::uint8_t> is_single, double cell);

/// Propagates changes to all loops that share a vertex, now or before; `before` may be empty.
void mark_merged(std::span<const std::size_t> before, std::span<const std::size_t> merged,
                 std::vector<std::uint8_t>* is_changed);

/// Indices of triangles with a side that occurs twice in the same direction and has a flagged end.
std::vector<std::size_t> repeating_triangles(std::span<const std::array<std::int32_t, 3>> triangles,
                                             const std::vector<std::uint8_t>& is_flagged);

/// The flagged vertices whose triangles do not form one closed fan.
std::vector<std::int32_t> pinched_vertices(std::span<const std::array<std::int32_t, 3>> triangles,
                                           const std::vector<std::uint8_t>& is_flagged);

/// Separates loops whose shared vertex would make the mesh non-manifold. `triangles` are the
/// triangles of `made`. Returns whether any were separated.
bool unmerge(std::span<const std::array<std::int32_t, 3>> triangles, const LoopTriangles& made,
             std::span<const std::size_t> merged, std::vector<std::uint8_t>* is_single,
             std::vector<std::uint8_t>* is_changed);

}  // namespace prefilter
