// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/voxels/solid/contour_coverage.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "prefilter/base/parallel.h"
#include "prefilter/voxels/queries.h"

namespace prefilter {
namespace {

constexpr std::int64_t kCoverageRowsPerTask = 1 << 12;
constexpr double kMarginCells = 3.0;  // around the box
// Offsets of the samples along the normal, in cells.
constexpr std::array<double, 5> kNormalOffsets = {0.0, -0.75, 0.75, -1.5, 1.5};
constexpr double kContourCoverageSampleCells = 2.0;

// Whether leaves along a normal lie on both sides of 1/2.
bool has_both_sides(const Octree& octree, const Vector3& point, const Vector3& normal) {
  bool is_any_inside = false;
  bool is_any_outside = false;
  for (const double step : kNormalOffsets) {
    const bool is_inside = value_at(octree, point + step * normal) >= 0.5F;
    (is_inside ? is_any_inside : is_any_outside) = true;
    if (is_any_inside && is_any_outside) return true;
  }
  return false;
}

bool is_inside_all_along(const Octree& octree, const Vector3& point, const Vector3& normal) {
  return std::all_of(kNormalOffsets.begin(), kNormalOffsets.end(),
                     [&](double step) { return value_at(octree, point + step * normal) >= 0.5F; });
}

// Calls set(triangle, share) with the share of each triangle's samples for which holds(triangle,
// point, normal) is true; the normal is one cell long.
template <class Holds, class Set>
void for_shares(const MeshView<std::int32_t>& mesh, double cell, const Run& run, const Holds& holds,
                const Set& set) {
  parallel_ranges(
      static_cast<std::int64_t>(mesh.triangles.size()), kCoverageRowsPerTask, run,
      [&](std::int64_t begin, std::int64_t end) {
        for (auto t = static_cast<std::size_t>(begin); t < static_cast<std::size_t>(end); ++t) {
          const std::array<Vector3, 3> corners = mesh.corners(t);
          Vector3 normal = cross(corners[1] - corners[0], corners[2] - corners[0]);
          const double size = length(normal);
          if (size > 0.0) {
            for (double& x : normal) x *= cell / size;
          }
          int count = 0;
          int covered = 0;
          for_samples(corners, kContourCoverageSampleCells * cell, [&](const Vector3& point) {
            ++count;
            if (holds(t, point, normal)) ++covered;
          });
          set(t, static_cast<float>(covered) / static_cast<float>(std::max(count, 1)));
        }
      });
}

}  // namespace

Octree empty_tree_around(const Box& box, double cell) {
  Octree octree;
  const double longest = std::max({box.size(0), box.size(1), box.size(2)});
  octree.depth = 1;
  while (octree.depth < kMaxTreeDepth &&
         std::ldexp(cell, octree.depth) < longest + 2.0 * kMarginCells * cell) {
    ++octree.depth;
  }
  double side = std::ldexp(cell, octree.depth);
  if (side < longest) side = longest * 1.01;
  for (int a = 0; a < 3; ++a) {
    const double middle = box.low[a] + box.size(a) / 2.0;
    octree.bounds.low[a] = middle - side / 2.0;
    octree.bounds.high[a] = middle + side / 2.0;
  }
  return octree;
}

std::vector<float> contour_coverage(const MeshView<std::int32_t>& mesh, const Octree& octree,
                                    const Run& run) {
  std::vector<float> shares(mesh.triangles.size(), 0.0F);
  for_shares(
      mesh, octree.cell_size(0, octree.depth), run,
      [&](std::size_t, const Vector3& point, const Vector3& normal) {
        return has_both_sides(octree, point, normal);
      },
      [&](std::size_t t, float share) { shares[t] = share; });
  return shares;
}

void add_covered(const MeshView<std::int32_t>& mesh, const Octree& octree, const Octree& others,
                 const std::vector<bool>& may_be_covered, const Run& run, std::span<float> shares) {
  for_shares(
      mesh, octree.cell_size(0, octree.depth), run,
      [&](std::size_t t, const Vector3& point, const Vector3& normal) {
        return may_be_covered[t] && is_inside_all_along(others, point, normal) &&
               is_inside_all_along(octree, point, normal);
      },
      [&](std::size_t t, float share) { shares[t] += share; });
}

}  // namespace prefilter
