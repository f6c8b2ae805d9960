// SPDX-License-Identifier: GPL-3.0-or-later

// Triangulates the boundary loops of a mesh.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/base/run.h"
#include "prefilter/voxels/close_holes.h"
#include "prefilter/voxels/solid/border_loops.h"

namespace prefilter {

/// Triangles over a loop. The loop's vertices come first in the numbering, then the added ones.
struct LoopCap {
  std::vector<Vector3> added;
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

/// Corner positions of a cap's triangle.
std::array<Vector3, 3> cap_corners(const PositionView& positions,
                                   std::span<const std::uint32_t> loop, const LoopCap& cap,
                                   std::size_t triangle);

/// A single triangle over three vertices; otherwise triangles to the center of the border.
LoopCap fan_over(const PositionView& positions, std::span<const std::uint32_t> loop);

/// Caps all loops that `is_kept` marks: with fans where `method` or the loop requires them, and
/// otherwise with patches of about the smallest area. `is_kept` has one entry per loop.
std::vector<LoopCap> first_caps(const InputMesh& mesh, const BorderLoops& loops,
                                std::span<const unsigned char> is_kept, HoleMethod method,
                                const Run& run);

/// Replaces these patches by ones that continue the surface.
void smooth_caps(const InputMesh& mesh, const BorderLoops& loops,
                 std::span<const unsigned char> is_kept, const Run& run,
                 std::vector<LoopCap>* caps);

/// Appends a cap for a mesh of `vertex_count` vertices.
void append_cap(std::size_t vertex_count, std::span<const std::uint32_t> loop, const LoopCap& cap,
                Caps* caps);

}  // namespace prefilter
