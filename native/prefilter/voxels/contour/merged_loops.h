// SPDX-License-Identifier: GPL-3.0-or-later

// Sharp loops that have one vertex together.
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

/// For each loop the first one of those that have its vertex: loops that are joined, and whose
/// features are closer than a twentieth of a cell, unless they are to stay single.
std::vector<std::size_t> merged_loops(const LinkedLoops& loops, std::span<const Feature> features,
                                      std::span<const std::uint8_t> is_sharp,
                                      std::span<const std::uint8_t> is_single, double cell);

/// What becomes of one loop becomes of all that have its vertex, now or before; `before` may be
/// empty.
void mark_merged(std::span<const std::size_t> before, std::span<const std::size_t> merged,
                 std::vector<std::uint8_t>* is_changed);

/// Of triangles, those with a side that is there twice in one direction, where one of the side's
/// ends is flagged.
std::vector<std::size_t> repeating_triangles(std::span<const std::array<std::int32_t, 3>> triangles,
                                             const std::vector<std::uint8_t>& is_flagged);

/// Of the vertices that are flagged, those whose triangles are not one closed fan.
std::vector<std::int32_t> pinched_vertices(std::span<const std::array<std::int32_t, 3>> triangles,
                                           const std::vector<std::uint8_t>& is_flagged);

/// Makes loops single where their vertex would leave the mesh something else than a two-manifold.
/// `triangles` are those of `made`. Returns whether any have become so.
bool unmerge(std::span<const std::array<std::int32_t, 3>> triangles, const LoopTriangles& made,
             std::span<const std::size_t> merged, std::vector<std::uint8_t>* is_single,
             std::vector<std::uint8_t>* is_changed);

}  // namespace prefilter
