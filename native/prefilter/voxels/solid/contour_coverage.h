// SPDX-License-Identifier: GPL-3.0-or-later

// Measures how much of a surface the contour of its voxels covers.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/base/run.h"
#include "prefilter/voxels/octree.h"

namespace prefilter {

/// An octree of one leaf around a box, with a depth at which cells have side `cell`, or are larger
/// where the tree would be too deep.
Octree empty_tree_around(const Box& box, double cell);

/// For each triangle, the share of its samples with leaves on both sides of 1/2 within 1.5 cells
/// along the normal, where the contour passes.
std::vector<float> contour_coverage(const MeshView<std::int32_t>& mesh, const Octree& octree,
                                    const Run& run);

/// Adds the shares of samples that are inside both `others` and the whole octree over the same
/// distance along the normal: other parts cover these, so they are not lost. Only for triangles
/// that `may_be_covered`.
void add_covered(const MeshView<std::int32_t>& mesh, const Octree& octree, const Octree& others,
                 const std::vector<bool>& may_be_covered, const Run& run, std::span<float> shares);

/// Calls visit(point) for points on a triangle about `distance` apart: its center, or the centers
/// of the triangles into which it is divided.
template <typename Visit>
void for_samples(const std::array<Vector3, 3>& corners, double distance, const Visit& visit) {
  constexpr double kMaxParts = 24.0;  // per side
  const double longest = std::max({length(corners[1] - corners[0]), length(corners[2] - corners[1]),
                                   length(corners[0] - corners[2])});
  const int parts = static_cast<int>(std::clamp(std::ceil(longest / distance), 1.0, kMaxParts));
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
