// SPDX-License-Identifier: GPL-3.0-or-later

// Contours grids of samples in space as closed meshes (chapter 5).
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

/// Position of the cells: cell (i, j, k) begins at origin + spacing * (i, j, k).
struct GridFrame {
  Vector3 origin{};
  Vector3 spacing{1.0, 1.0, 1.0};
};

/// Contours the samples by marching cubes, like contour_tree, on an octree of the grid in which
/// blocks of equal samples away from the surface are leaves. The outside of the grid is empty.
/// Throws Error where a side is out of range, a sample is not a number, or the frame's cells have
/// no volume; also the errors of contour_tree.
TriangleMesh contour_grid(const GridView& grid, const GridFrame& frame,
                          const ContourOptions& options);

}  // namespace prefilter
