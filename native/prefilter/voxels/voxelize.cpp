// SPDX-License-Identifier: GPL-3.0-or-later

// Implements section 3.2.3. The mesh is mapped to the unit cube; this may stretch it, which does
// not change occupancies.
#include "prefilter/voxels/voxelize.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "prefilter/base/error.h"
#include "prefilter/base/memory.h"
#include "prefilter/base/parallel.h"
#include "prefilter/base/text.h"
#include "prefilter/voxels/thicken.h"
#include "prefilter/wavelet/triangle_analysis.h"

namespace prefilter {
namespace {

constexpr double kMarginCells = 2.0;        // around the mesh
constexpr double kMarginShare = 1.0 / 8.0;  // upper limit, as a share of the cells along an axis
constexpr std::int64_t kVoxelizeRowsPerTask = 1 << 14;
// Bytes per cell that the surface passes through, for blocks while they are merged and for the
// bricks' triangles. Measured on scans: 20 to 25.
constexpr double kBytesPerCell = 30.0;

Box box_of(const InputMesh& mesh) {
  Box box = kEmptyBox;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (const Vector3& corner : mesh.corners(t)) box.include(corner);
  }
  return box;
}

// Number of unit cells that a large planar figure crosses: the sum of its area vector's absolute
// components.
double cells_crossed(const std::array<Vector3, 3>& corners) {
  const Vector3 normal = cross(corners[1] - corners[0], corners[2] - corners[0]);
  return (std::abs(normal[0]) + std::abs(normal[1]) + std::abs(normal[2])) / 2.0;
}

// Number of cells that some triangles cross, in units of the root, and whether any of them has an
// area.
struct SurfaceExtent {
  double cells = 0.0;
  bool has_area = false;
};

SurfaceExtent extent_of(const RootTriangles& mesh, std::int64_t begin, std::int64_t end) {
  SurfaceExtent extent;
  for (std::int64_t t = begin; t < end; ++t) {
    const std::array<Vector3, 3> corners = mesh.corners(static_cast<std::size_t>(t));
    bool meets_root = true;
    for (int a = 0; a < 3; ++a) {
      meets_root = meets_root && std::min({corners[0][a], corners[1][a], corners[2][a]}) <= 1.0 &&
                   std::max({corners[0][a], corners[1][a], corners[2][a]}) >= 0.0;
    }
    const double area = cells_crossed(corners);
    extent.has_area = extent.has_area || area > 0.0;
    // A plane crosses at most about three layers of the root.
    if (meets_root) extent.cells += std::min(area, 3.0);
  }
  return extent;
}

// Throws Error if all triangles have zero area, or the tree would not fit into memory.
void check_surface(const RootTriangles& mesh, int depth, const Run& run) {
  const auto count = static_cast<std::int64_t>(mesh.mesh.triangles.size());
  std::vector<SurfaceExtent> parts(
      static_cast<std::size_t>(range_count(count, kVoxelizeRowsPerTask)));
  parallel_ranges(count, kVoxelizeRowsPerTask, run, [&](std::int64_t begin, std::int64_t end) {
    parts[static_cast<std::size_t>(begin / kVoxelizeRowsPerTask)] = extent_of(mesh, begin, end);
  });
  SurfaceExtent all;
  for (const SurfaceExtent& part : parts) {
    all.cells += part.cells;
    all.has_area = all.has_area || part.has_area;
  }
  if (!all.has_area) {
    throw_invalid("triangles: all " + std::to_string(mesh.mesh.triangles.size()) +
                  " have zero area; at least one with an area is needed");
  }
  check_memory("depth: a tree of depth " + std::to_string(depth) + " of this mesh",
               kBytesPerCell * std::ldexp(all.cells, 2 * depth));
}
}  // namespace

Box cube_around(const Box& box, int depth) {
  check_depth(depth, 1, "depth");
  const double longest = std::max({box.size(0), box.size(1), box.size(2)});
  const double cells = std::ldexp(1.0, depth);
  const double margin = std::min(kMarginCells, cells * kMarginShare);
  const double half = longest * cells / (cells - 2.0 * margin) / 2.0;
  Box cube;
  for (int a = 0; a < 3; ++a) {
    const double middle = box.low[a] + box.size(a) / 2.0;
    cube.low[a] = middle - half;
    cube.high[a] = middle + half;
  }
  return cube;
}

Octree voxelize(const InputMesh& mesh, const VoxelizeOptions& options) {
  check_depth(options.depth, 1, "depth");
  if (options.bounds) check_box(*options.bounds, "bounds");
  check_mesh(mesh, kLargestCoordinate);
  if (!(std::isfinite(options.thickness) && options.thickness >= 0.0)) {
    throw_invalid("thickness: " + to_text(options.thickness) +
                  "; a finite number of 0 or more is needed");
  }
  Octree octree;
  octree.depth = options.depth;
  if (options.bounds) {
    octree.bounds = *options.bounds;
  } else {
    octree.bounds = cube_around(box_of(mesh), options.depth);
    if (!(octree.bounds.size(0) > 0.0)) {
      throw_invalid("triangles: all " + std::to_string(mesh.triangles.size()) +
                    " have zero area; at least one with an area is needed");
    }
    check_box(octree.bounds, "positions");
  }

  const bool is_thickened = options.thickness > 0.0;
  const Run making = options.run.part(0.0, is_thickened ? 0.5 : 1.0);
  const RootTriangles in_root{mesh, octree.bounds};
  const Stages stages(making, {1, 17, 2});
  check_surface(in_root, options.depth, stages[0]);
  HaarTree coefficients = analyze_triangles(in_root, options.depth, stages[1]);
  octree.cells = synthesise(std::move(coefficients), -1, stages[2]);
  if (is_thickened) {
    thicken(in_root, options.thickness, options.run.part(0.5, 1.0), &octree);
  }
  return octree;
}

}  // namespace prefilter
