// SPDX-License-Identifier: GPL-3.0-or-later

// Triangles of a mesh in parts that can change at the same time.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "prefilter/base/progress.h"

namespace prefilter {

/// Lists of triangles, one behind the other.
struct TriangleParts {
  std::vector<std::uint32_t> triangles;
  std::vector<std::size_t> begins = {0};  // and the end

  std::size_t count() const { return begins.size() - 1; }
  std::span<const std::uint32_t> part(std::size_t i) const {
    return std::span(triangles).subspan(begins[i], begins[i + 1] - begins[i]);
  }
  /// Of each of `count` triangles, its part; `none` where it has none.
  std::vector<std::uint32_t> numbers(std::size_t count, std::uint32_t none) const;
};

/// All triangles, in order within a part, by their first vertices: those that follow each other
/// are near each other, as far as the mesh comes from a contour. Throws Error(kCancelled).
TriangleParts parts_along_vertices(std::span<const std::array<std::int32_t, 3>> triangles,
                                   std::size_t vertex_count, const Progress& progress, int threads);

/// Of the vertices of each part: the part with all of their triangles, or EditedMesh::kSeveral.
/// What no part has stays as it is. Throws Error(kCancelled).
void find_owners(const TriangleParts& parts, std::span<const std::array<std::int32_t, 3>> triangles,
                 const Progress& progress, int threads, std::vector<std::uint32_t>* owners);

/// These triangles, in parts that have no vertex that is inner in common; each has one at least.
/// `parents` has a place for each vertex, and is left with anything in it.
TriangleParts parts_by_inner_vertices(std::span<const std::array<std::int32_t, 3>> triangles,
                                      std::span<const std::uint32_t> chosen,
                                      const std::vector<std::uint8_t>& is_inner,
                                      std::vector<std::uint32_t>* parents);

}  // namespace prefilter
