// SPDX-License-Identifier: GPL-3.0-or-later

// Divides triangles into parts that can be edited concurrently.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "prefilter/base/run.h"

namespace prefilter {

/// Consecutive lists of triangles.
struct TriangleParts {
  std::vector<std::uint32_t> triangles;
  std::vector<std::size_t> begins = {0};  // and the end of the last

  std::size_t count() const { return begins.size() - 1; }
  std::span<const std::uint32_t> part(std::size_t i) const {
    return std::span(triangles).subspan(begins[i], begins[i + 1] - begins[i]);
  }
  /// The part of each of `count` triangles; `none` for those in no part.
  std::vector<std::uint32_t> part_numbers(std::size_t count, std::uint32_t none) const;
};

/// Divides all triangles by their lowest vertices, in order within a part. In meshes from contours,
/// nearby vertex indices are near each other. Throws Error(kCancelled).
TriangleParts parts_along_vertices(std::span<const std::array<std::int32_t, 3>> triangles,
                                   std::size_t vertex_count, const Run& run);

/// Sets the owner of each part's vertices: the part with all of their triangles, or
/// EditedMesh::kShared. Vertices in no part are unchanged. Throws Error(kCancelled).
void find_owners(const TriangleParts& parts, std::span<const std::array<std::int32_t, 3>> triangles,
                 const Run& run, std::vector<std::uint32_t>* owners);

/// Divides the chosen triangles into parts that share no inner vertex; each triangle must have at
/// least one. `parents` is scratch space with one entry per vertex.
TriangleParts parts_by_inner_vertices(std::span<const std::array<std::int32_t, 3>> triangles,
                                      std::span<const std::uint32_t> chosen,
                                      const std::vector<std::uint8_t>& is_inner,
                                      std::vector<std::uint32_t>* parents);

}  // namespace prefilter
