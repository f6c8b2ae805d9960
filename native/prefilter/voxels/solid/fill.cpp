// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/voxels/solid/fill.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <unordered_map>

#include "prefilter/base/cancel_check.h"
#include "prefilter/voxels/grid_contour.h"
#include "prefilter/wavelet/cell_polygon.h"

namespace prefilter {
namespace {

constexpr double kMinPlaneSlope = 1e-4;  // avoids division by 0

// The mean plane of the triangles in a cell, in cells from the cell's low corner.
struct CellPlane {
  Vector3 normal{};  // points out of the filled region; sum of area vectors
  Vector3 middle{};  // area-weighted center
  double area = 0.0;

  // The share of the cell behind the plane: the volume of the tetrahedron that the plane cuts off
  // the octant, minus the parts beyond the cell's sides, by inclusion and exclusion.
  float share() const {
    const double across = std::abs(normal[0]) + std::abs(normal[1]) + std::abs(normal[2]);
    if (!(across > 0.0)) return 0.5F;
    Vector3 slopes;
    double offset = 0.0;
    for (std::size_t a = 0; a < 3; ++a) {
      // Mirror the axes so that all slopes are positive, and clamp them to avoid cancellation.
      slopes[a] = std::max(std::abs(normal[a]) / across, kMinPlaneSlope);
      const double at = middle[a] / area;
      offset += slopes[a] * (normal[a] < 0.0 ? 1.0 - at : at);
    }
    double sum = 0.0;
    for (unsigned corner = 0; corner < 8; ++corner) {
      double rest = offset;
      for (std::size_t a = 0; a < 3; ++a) rest -= ((corner >> a) & 1U) != 0U ? slopes[a] : 0.0;
      const double cube = rest > 0.0 ? rest * rest * rest : 0.0;
      sum += (std::popcount(corner) & 1) != 0 ? -cube : cube;
    }
    return static_cast<float>(
        std::clamp(sum / (6.0 * slopes[0] * slopes[1] * slopes[2]), 0.0, 1.0));
  }
};

void add_piece(const std::array<int, 3>& cell, const CellPolygon& piece, double sign,
               CellPlane* plane) {
  for (int i = 1; i + 1 < piece.count; ++i) {
    const std::array<Vector3, 3> p = {piece.corners[0], piece.corners[i], piece.corners[i + 1]};
    const Vector3 doubled = cross(p[1] - p[0], p[2] - p[0]);
    const double area = length(doubled) / 2.0;
    for (std::size_t a = 0; a < 3; ++a) {
      plane->normal[a] += sign * doubled[a] / 2.0;
      plane->middle[a] += area * ((p[0][a] + p[1][a] + p[2][a]) / 3.0 - cell[a]);
    }
    plane->area += area;
  }
}

// Planes, per cell, of the triangles with a filled region on exactly one side.
using CellPlanes = std::unordered_map<std::size_t, CellPlane>;
CellPlanes planes_of(const MeshView<std::int32_t>& mesh, const ReachGrid& grid,
                     const std::vector<bool>& is_filled, const Run& run) {
  CellPlanes planes;
  const CellBox all = {{0, 0, 0}, grid.size()};
  CancelCheck cancel_check(run);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    cancel_check.step();
    const std::array<Vector3, 3> corners = mesh.corners(t);
    Vector3 normal = cross(corners[1] - corners[0], corners[2] - corners[0]);
    const double size = length(normal);
    if (!(size > 0.0)) continue;
    for (double& x : normal) x /= size;
    const Vector3 back = {-normal[0], -normal[1], -normal[2]};
    CellPolygon polygon;
    for (const Vector3& corner : corners) {
      Vector3 at;
      for (std::size_t a = 0; a < 3; ++a) at[a] = (corner[a] - grid.origin()[a]) / grid.cell();
      polygon.add(at);
    }
    cut_polygon(polygon, all, [&](const std::array<int, 3>& cell, const CellPolygon& piece) {
      Vector3 middle{};
      for (int i = 0; i < piece.count; ++i) {
        for (std::size_t a = 0; a < 3; ++a) middle[a] += piece.corners[i][a] / piece.count;
      }
      for (std::size_t a = 0; a < 3; ++a) middle[a] = grid.origin()[a] + middle[a] * grid.cell();
      const bool is_front = is_filled[grid.first_beyond_surface(middle, normal)];
      const bool is_back = is_filled[grid.first_beyond_surface(middle, back)];
      if (is_front == is_back) return;
      add_piece(cell, piece, is_back ? 1.0 : -1.0, &planes[grid.index(cell[0], cell[1], cell[2])]);
    });
  }
  return planes;
}

// Whether a surface cell is a wall inside filled regions. The grid's margin guarantees neighbors.
bool is_inner_wall(int x, int y, int z, const ReachGrid& grid, const std::vector<bool>& is_filled) {
  bool is_within = true;
  bool is_beside = false;
  for (const std::size_t next :
       {grid.index(x - 1, y, z), grid.index(x + 1, y, z), grid.index(x, y - 1, z),
        grid.index(x, y + 1, z), grid.index(x, y, z - 1), grid.index(x, y, z + 1)}) {
    const ReachGrid::Label label = grid.labels()[next];
    is_within = is_within && (label == ReachGrid::kSurface || is_filled[label]);
    is_beside = is_beside || is_filled[label];
  }
  return is_within && is_beside;
}

// Filled share of each cell.
std::vector<float> filled_cells(const ReachGrid& grid, const std::vector<bool>& is_filled,
                                const CellPlanes& planes) {
  const std::vector<ReachGrid::Label>& labels = grid.labels();
  std::vector<float> values(labels.size(), 0.0F);
  const auto [nx, ny, nz] = grid.size();
  for (int x = 0; x < nx; ++x) {
    for (int y = 0; y < ny; ++y) {
      for (int z = 0; z < nz; ++z) {
        const std::size_t i = grid.index(x, y, z);
        if (labels[i] != ReachGrid::kSurface) {
          values[i] = is_filled[labels[i]] ? 1.0F : 0.0F;
          continue;
        }
        const auto plane = planes.find(i);
        values[i] = plane != planes.end() ? plane->second.share()
                                          : (is_inner_wall(x, y, z, grid, is_filled) ? 1.0F : 0.0F);
      }
    }
  }
  return values;
}

}  // namespace

TriangleMesh filled_regions(const MeshView<std::int32_t>& mesh, const ReachGrid& grid,
                            const std::vector<bool>& is_filled, const Run& run) {
  const std::vector<float> values =
      filled_cells(grid, is_filled, planes_of(mesh, grid, is_filled, run.part(0.0, 0.5)));
  ContourOptions options;
  options.interpolant = Interpolant::kPlane;
  options.clean_up = false;
  options.run = run.part(0.6, 1.0);
  const double cell = grid.cell();
  return contour_grid({values.data(), grid.size()}, {grid.origin(), {cell, cell, cell}}, options);
}

}  // namespace prefilter
