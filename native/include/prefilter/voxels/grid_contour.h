// SPDX-License-Identifier: GPL-3.0-or-later

// Grids of samples in space to closed meshes (chapter 5).
#pragma once

#include <array>
#include <cstddef>

#include "prefilter/base/geometry.h"
#include "prefilter/voxels/contour_options.h"

namespace prefilter {

/// Samples at [(x * size[1] + y) * size[2] + z], at the centers of cells (x + 1/2, y + 1/2, z +
/// 1/2).
struct GridView {
  const float* values = nullptr;
  std::array<int, 3> size{};  // cells along the axes, 1 to 4096

  std::size_t index(int x, int y, int z) const {
    return (static_cast<std::size_t>(x) * static_cast<std::size_t>(size[1]) +
            static_cast<std::size_t>(y)) *
               static_cast<std::size_t>(size[2]) +
           static_cast<std::size_t>(z);
  }
  float at(int x, int y, int z) const { return values[index(x, y, z)]; }
};

/// Where cells are: cell (i, j, k) begins at origin + spacing * (i, j, k).
struct GridFrame {
  Vector3 origin{};
  Vector3 spacing{1.0, 1.0, 1.0};
};

/// Marching cubes on the samples. As contour_tree does: the octree is made of the grid, with blocks
/// of equal samples away from the surface as leaves. What is outside of the grid is empty. Throws
/// Error where a side is out of range, a sample is not a number, or the frame's cells have no
/// volume, and what contour_tree throws.
TriangleMesh contour_grid(const GridView& grid, const GridFrame& frame,
                          const ContourOptions& options);

}  // namespace prefilter
