// SPDX-License-Identifier: GPL-3.0-or-later

// Where a small part of a mesh that has changed meets the rest.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/base/progress.h"

namespace prefilter {

/// The triangles that are in one cube with a suspect, in order, and the suspects themselves.
struct NearTriangles {
  std::vector<std::array<std::int32_t, 3>> triangles;
  std::vector<std::uint8_t> is_suspect;
  std::vector<std::uint32_t> numbers;  // in the mesh
};

/// Those of a mesh from `first` on whose first corner is not negative. Cubes have this side; a few
/// more triangles may be among them. Throws Error(kCancelled), as the others do.
NearTriangles near_triangles(const MeshView<std::int32_t>& mesh, std::size_t first,
                             std::span<const std::uint8_t> is_suspect, double side,
                             const Progress& progress);

/// Those of the suspects that may meet others, or fold: in a cube where normals are more than 60
/// degrees off. For a mesh that did not meet itself before pieces of it were made anew.
std::vector<std::uint8_t> where_rough(const MeshView<std::int32_t>& mesh, std::size_t first,
                                      std::vector<std::uint8_t> is_suspect, double side,
                                      const Progress& progress);

/// The pairs of intersecting_triangles, of all from `first` on, with one suspect at least. Only
/// triangles are looked at that are in one cube with a suspect.
std::vector<std::array<std::uint32_t, 2>> near_intersections(
    const MeshView<std::int32_t>& mesh, std::size_t first, std::span<const std::uint8_t> is_suspect,
    double side, const Progress& progress, int threads);

}  // namespace prefilter
