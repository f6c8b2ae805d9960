// Section 3.2.3. The mesh is carried to the unit cube, which may stretch it: occupancies do not
// change.
#include "prefilter/voxel/voxelize.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "prefilter/base/error.h"
#include "prefilter/base/memory.h"
#include "prefilter/base/parallel.h"
#include "prefilter/base/text.h"
#include "prefilter/wavelet/triangle_analysis.h"

namespace prefilter {
namespace {

constexpr double kMarginCells = 2.0;
constexpr double kMarginShare = 1.0 / 8.0;  // of the cells along an axis, at the most
constexpr std::size_t kRowsPerTask = 1U << 14;
// Of a cell that the surface passes through: blocks while they are moved together, and the bricks'
// triangles. Measured on scans: 20 to 25.
constexpr double kBytesPerCell = 30.0;

std::size_t task_count(std::size_t rows) { return (rows + kRowsPerTask - 1) / kRowsPerTask; }

void for_rows(std::size_t rows, int threads,
              const std::function<void(std::size_t, std::size_t)>& body) {
  parallel_for(static_cast<std::int64_t>(task_count(rows)), threads, Progress(),
               [&](std::int64_t task) {
                 const std::size_t begin = static_cast<std::size_t>(task) * kRowsPerTask;
                 body(begin, std::min(rows, begin + kRowsPerTask));
               });
}

Box box_of(const SolidMesh& mesh) {
  Box box;
  box.low.fill(std::numeric_limits<double>::infinity());
  box.high.fill(-std::numeric_limits<double>::infinity());
  for (const auto& triangle : mesh.triangles) {
    for (const std::int64_t vertex : triangle) {
      const auto& p = mesh.positions[static_cast<std::size_t>(vertex)];
      for (int a = 0; a < 3; ++a) {
        box.low[a] = std::min(box.low[a], p[a]);
        box.high[a] = std::max(box.high[a], p[a]);
      }
    }
  }
  return box;
}

// The area vector's absolute components, summed: the number of unit cells that a large plane figure
// passes through.
double cells_met(const std::array<Point3, 3>& corners) {
  Point3 u;
  Point3 v;
  for (int a = 0; a < 3; ++a) {
    u[a] = corners[1][a] - corners[0][a];
    v[a] = corners[2][a] - corners[0][a];
  }
  double sum = 0.0;
  for (int a = 0; a < 3; ++a) {
    const int b = (a + 1) % 3;
    const int c = (a + 2) % 3;
    sum += std::abs(u[b] * v[c] - u[c] * v[b]) / 2.0;
  }
  return sum;
}

// Of some triangles: the cells of a tree that they meet, with the root for a unit, and whether any
// has an area.
struct SurfaceExtent {
  double cells = 0.0;
  bool has_area = false;
};

SurfaceExtent extent_of(const RootTriangles& mesh, std::size_t begin, std::size_t end) {
  SurfaceExtent extent;
  for (std::size_t t = begin; t < end; ++t) {
    std::array<Point3, 3> corners;
    bool meets_root = true;
    for (int i = 0; i < 3; ++i) {
      corners[i] = mesh.positions[static_cast<std::size_t>(mesh.triangles[t][i])];
    }
    for (int a = 0; a < 3; ++a) {
      meets_root = meets_root && std::min({corners[0][a], corners[1][a], corners[2][a]}) <= 1.0 &&
                   std::max({corners[0][a], corners[1][a], corners[2][a]}) >= 0.0;
    }
    const double area = cells_met(corners);
    extent.has_area = extent.has_area || area > 0.0;
    // No plane meets more than about three layers of the root.
    if (meets_root) extent.cells += std::min(area, 3.0);
  }
  return extent;
}

// Throws where all triangles have zero area, or the tree would not fit.
void check_surface(const RootTriangles& mesh, int depth, int threads) {
  std::vector<SurfaceExtent> parts(task_count(mesh.triangles.size()));
  for_rows(mesh.triangles.size(), threads, [&](std::size_t begin, std::size_t end) {
    parts[begin / kRowsPerTask] = extent_of(mesh, begin, end);
  });
  SurfaceExtent all;
  for (const SurfaceExtent& part : parts) {
    all.cells += part.cells;
    all.has_area = all.has_area || part.has_area;
  }
  if (!all.has_area) {
    throw_invalid("triangles: all " + std::to_string(mesh.triangles.size()) +
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

void check_mesh(const SolidMesh& mesh) {
  if (mesh.triangles.empty()) throw_invalid("triangles: none; at least one is needed");
  if (mesh.triangles.size() > std::numeric_limits<std::uint32_t>::max() ||
      mesh.positions.size() > static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max())) {
    throw_invalid("triangles: too many; 2^32 triangles and 2^31 positions are the most");
  }
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    for (const double x : mesh.positions[i]) {
      // The difference of any two has to be finite as well.
      if (std::abs(x) <= 1e300) continue;
      throw_invalid("positions: row " + std::to_string(i) + " holds " + to_text(x) +
                    "; all values must be finite, and at most 1e300");
    }
  }
  const auto count = static_cast<std::int64_t>(mesh.positions.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (const std::int64_t vertex : mesh.triangles[t]) {
      if (vertex >= 0 && vertex < count) continue;
      throw_invalid("triangles: triangle " + std::to_string(t) + " names vertex " +
                    std::to_string(vertex) + "; there are " + std::to_string(count) +
                    ", from 0 on");
    }
  }
}

Octree voxelize(const SolidMesh& mesh, const VoxelizeOptions& options) {
  check_depth(options.depth, 1, "depth");
  if (options.bounds) check_box(*options.bounds, "bounds");
  check_mesh(mesh);
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

  const Box& bounds = octree.bounds;
  // Not set to zero first, so that the threads that write touch the memory.
  const auto position_memory = std::make_unique_for_overwrite<Point3[]>(mesh.positions.size());
  const std::span positions(position_memory.get(), mesh.positions.size());
  for_rows(positions.size(), options.threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      for (int a = 0; a < 3; ++a) {
        positions[i][a] = (mesh.positions[i][a] - bounds.low[a]) / bounds.size(a);
      }
    }
  });
  const auto triangle_memory =
      std::make_unique_for_overwrite<std::array<std::int32_t, 3>[]>(mesh.triangles.size());
  const std::span triangles(triangle_memory.get(), mesh.triangles.size());
  for_rows(triangles.size(), options.threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t t = begin; t < end; ++t) {
      for (int i = 0; i < 3; ++i) triangles[t][i] = static_cast<std::int32_t>(mesh.triangles[t][i]);
    }
  });
  const RootTriangles in_root{positions, triangles};
  check_surface(in_root, options.depth, options.threads);
  HaarTree coefficients =
      analyse_triangles(in_root, options.depth, options.progress.part(0.0, 0.9), options.threads);
  octree.cells =
      synthesise(std::move(coefficients), -1, options.progress.part(0.9, 1.0), options.threads);
  return octree;
}

}  // namespace prefilter
