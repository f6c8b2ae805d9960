// SPDX-License-Identifier: GPL-3.0-or-later

// What of a surface is left in its voxels.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/base/progress.h"
#include "prefilter/voxels/octree.h"

namespace prefilter {

/// The root of a tree with cells of this side around a box, and its depth; of larger cells where
/// the tree would be too deep.
Octree empty_tree_around(const Box& box, double cell);

/// Of each triangle, the share of samples of it that have leaves on both sides of 1/2 within one
/// and a half cells along the normal: where a contour passes by.
std::vector<float> kept_shares(const MeshView<std::int32_t>& mesh, const Octree& octree,
                               const Progress& progress, int threads);

/// Adds to these shares those of the samples inside `others`, and inside the whole octree, as far
/// along the normal: nothing is lost there, as other parts cover it. Of triangles that may be.
void add_covered(const MeshView<std::int32_t>& mesh, const Octree& octree, const Octree& others,
                 const std::vector<bool>& may_be_covered, const Progress& progress, int threads,
                 std::span<float> shares);

/// Calls visit(point) for points of a triangle that are about `distance` apart: its middle, or the
/// middles of the parts it is cut into.
template <typename Visit>
void for_samples(const std::array<Vector3, 3>& corners, double distance, const Visit& visit) {
  constexpr double kMostParts = 24.0;
  const double longest = std::max({length(corners[1] - corners[0]), length(corners[2] - corners[1]),
                                   length(corners[0] - corners[2])});
  const int parts = static_cast<int>(std::clamp(std::ceil(longest / distance), 1.0, kMostParts));
  const double step = 1.0 / parts;
  for (int i = 0; i < parts; ++i) {
    for (int j = 0; i + j < parts; ++j) {
      for (int upper = 0; upper < (i + j + 1 < parts ? 2 : 1); ++upper) {
        const double shift = (1.0 + upper) / 3.0;
        const double u = (i + shift) * step;
        const double v = (j + shift) * step;
        Vector3 point;
        for (std::size_t a = 0; a < 3; ++a) {
          point[a] = (1.0 - u - v) * corners[0][a] + u * corners[1][a] + v * corners[2][a];
        }
        visit(point);
      }
    }
  }
}

}  // namespace prefilter
