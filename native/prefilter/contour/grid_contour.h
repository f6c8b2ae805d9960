// Grids of samples to closed outlines and meshes (chapter 5).
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "prefilter/base/triangle_mesh.h"
#include "prefilter/contour/contour_options.h"

namespace prefilter {

/// Samples at [(x * size[1] + y) * size[2] + z], at the centres of cells (x + 1/2, y + 1/2, z +
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
  std::array<double, 3> origin{};
  std::array<double, 3> spacing{1.0, 1.0, 1.0};
};

/// Marching cubes on the samples. As contour_tree does: the octree is made of the grid, with blocks
/// of equal samples away from the surface as leaves. What is outside of the grid is empty. Throws
/// Error where a side is out of range or a sample is not a number, and what contour_tree throws.
TriangleMesh contour_grid(const GridView& grid, const GridFrame& frame,
                          const ContourOptions& options);

using Polyline = std::vector<std::array<float, 2>>;

/// The outlines of a grid that is one cell thick along z: closed polylines, the last point joined
/// to the first, with the inside to their left. "occupancy" and "plane" are the same here: exact
/// for straight edges (section 5.2). Throws as contour_grid does.
std::vector<Polyline> contour_image(const GridView& image, const GridFrame& frame,
                                    const ContourOptions& options);

}  // namespace prefilter
