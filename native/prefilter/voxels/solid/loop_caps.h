// SPDX-License-Identifier: GPL-3.0-or-later

// Triangles over the loops of a mesh's border.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/base/progress.h"
#include "prefilter/voxels/close_holes.h"
#include "prefilter/voxels/solid/border_loops.h"

namespace prefilter {

/// The triangles over a loop. Its vertices have the first numbers, those that are added the next.
struct LoopCap {
  std::vector<Vector3> added;
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

/// The corners of a triangle of a cap.
std::array<Vector3, 3> cap_corners(const PositionView& positions,
                                   std::span<const std::uint32_t> loop, const LoopCap& cap,
                                   std::size_t triangle);

/// A triangle over three vertices, and triangles to the middle of the line over more.
LoopCap fan_over(const PositionView& positions, std::span<const std::uint32_t> loop);

/// Fans over the loops that `method` closes so, and patches of about the smallest area over the
/// others. `is_kept` has an entry for each loop; those of 0 get no cap.
std::vector<LoopCap> first_caps(const InputMesh& mesh, const BorderLoops& loops,
                                std::span<const unsigned char> is_kept, HoleMethod method,
                                const Progress& progress, int threads);

/// Replaces those patches by others that continue the surface.
void smooth_caps(const InputMesh& mesh, const BorderLoops& loops,
                 std::span<const unsigned char> is_kept, const Progress& progress, int threads,
                 std::vector<LoopCap>* caps);

/// Appends a cap to those of a mesh of so many vertices.
void append_cap(std::size_t vertex_count, std::span<const std::uint32_t> loop, const LoopCap& cap,
                Caps* caps);

}  // namespace prefilter
