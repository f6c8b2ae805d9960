// SPDX-License-Identifier: GPL-3.0-or-later

// Finds intersections of the changed part of a mesh with the rest.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/base/run.h"

namespace prefilter {

/// The triangles that share a cube with a suspect, including the suspects, in order.
struct NearTriangles {
  std::vector<std::array<std::int32_t, 3>> triangles;
  std::vector<std::uint8_t> is_suspect;
  std::vector<std::uint32_t> numbers;  // index in the mesh
};

/// Collects triangles from `first` on that are not removed (first corner negative), in cubes of
/// side `side`. The result may include a few more triangles. Throws Error(kCancelled), as all
/// functions here.
NearTriangles near_triangles(const MeshView<std::int32_t>& mesh, std::size_t first,
                             std::span<const std::uint8_t> is_suspect, double side, const Run& run);

/// Clears the flags of suspects that cannot intersect others or fold, as all normals in their cubes
/// are within 60 degrees of each other. Requires that the mesh did not intersect itself before
/// pieces of it were replaced.
std::vector<std::uint8_t> keep_rough_suspects(const MeshView<std::int32_t>& mesh, std::size_t first,
                                              std::vector<std::uint8_t> is_suspect, double side,
                                              const Run& run);

/// The pairs of intersecting_triangles, among triangles from `first` on, with at least one suspect.
/// Tests only triangles that share a cube with a suspect.
std::vector<std::array<std::uint32_t, 2>> near_intersections(
    const MeshView<std::int32_t>& mesh, std::size_t first, std::span<const std::uint8_t> is_suspect,
    double side, const Run& run);

}  // namespace prefilter
