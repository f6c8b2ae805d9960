// SPDX-License-Identifier: GPL-3.0-or-later

// The edges of a mesh and the triangles at each.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "prefilter/base/geometry.h"
#include "prefilter/voxels/solid/buckets.h"

namespace prefilter {

/// The use of an edge by a triangle.
struct EdgeUse {
  std::uint32_t triangle;
  bool is_down;  // whether the triangle traverses it from the higher vertex index to the lower
};

/// All edge uses of a mesh with valid indices. Degenerate edges are left out.
class EdgeTable {
 public:
  template <typename Mesh>
  EdgeTable(const Mesh& mesh, const Run& run)
      : uses_(
            mesh.positions.size(), mesh.triangles.size(),
            [&](std::size_t begin, std::size_t end, const auto& put) {
              for (std::size_t t = begin; t < end; ++t) {
                for (std::size_t i = 0; i < 3; ++i) {
                  const auto from = static_cast<std::uint64_t>(mesh.triangles[t][i]);
                  const auto to = static_cast<std::uint64_t>(mesh.triangles[t][(i + 1) % 3]);
                  if (from < to) put(from, (to << 33U) | t);
                  if (to < from) put(to, (from << 33U) | kDown | t);
                }
              }
            },
            run) {}

  std::size_t vertex_count() const { return uses_.size(); }

  /// Calls visit(high, uses) for the edges from vertex `low` to higher vertices; decode each
  /// element of `uses` with `use`.
  template <typename Visit>
  void for_edges_from(std::size_t low, const Visit& visit) const {
    const std::span<const std::uint64_t> all = uses_[low];
    for (std::size_t i = 0; i < all.size();) {
      const std::uint64_t high = all[i] >> 33U;
      std::size_t end = i + 1;
      while (end < all.size() && all[end] >> 33U == high) ++end;
      visit(static_cast<std::size_t>(high), all.subspan(i, end - i));
      i = end;
    }
  }

  static EdgeUse use(std::uint64_t number) {
    return {static_cast<std::uint32_t>(number & 0xFFFFFFFFU), (number & kDown) != 0};
  }

 private:
  static constexpr std::uint64_t kDown = std::uint64_t{1} << 32U;
  Buckets uses_;
};

}  // namespace prefilter
