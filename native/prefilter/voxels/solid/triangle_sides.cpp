// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/voxels/solid/triangle_sides.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "prefilter/base/parallel.h"
#include "prefilter/voxels/solid/contour_coverage.h"

namespace prefilter {
namespace {

constexpr std::int64_t kSidesPerTask = 1 << 10;
constexpr double kTriangleSidesSampleCells = 2.0;  // distance between samples

bool is_region(ReachGrid::Label label) { return label >= ReachGrid::kFirstRegion; }
bool is_outside(ReachGrid::Label label) { return label == ReachGrid::kOutside; }

TriangleSides sides_of(const std::array<Vector3, 3>& corners, const ReachGrid& grid) {
  TriangleSides sides;
  Vector3 normal = cross(corners[1] - corners[0], corners[2] - corners[0]);
  const double size = length(normal);
  if (!(size > 0.0)) return sides;
  for (double& x : normal) x /= size;
  const Vector3 back = {-normal[0], -normal[1], -normal[2]};
  float samples = 0.0F;
  for_samples(corners, kTriangleSidesSampleCells * grid.cell(), [&](const Vector3& point) {
    samples += 1.0F;
    const ReachGrid::Label in_front = grid.first_beyond_surface(point, normal);
    const ReachGrid::Label behind = grid.first_beyond_surface(point, back);
    if (is_outside(in_front) && is_outside(behind)) sides.outside_both += 1.0F;
    if (is_region(in_front) && is_region(behind)) sides.inside_both += 1.0F;
    if (is_outside(in_front) && is_region(behind)) sides.outside_front += 1.0F;
    if (is_region(in_front) && is_outside(behind)) sides.outside_back += 1.0F;
    if (is_region(in_front) != is_region(behind)) {
      sides.region = is_region(in_front) ? in_front : behind;
    }
  });
  for (float* share :
       {&sides.outside_both, &sides.outside_front, &sides.outside_back, &sides.inside_both}) {
    *share /= samples;
  }
  return sides;
}

}  // namespace

std::vector<TriangleSides> sides_of_triangles(const MeshView<std::int32_t>& mesh,
                                              const ReachGrid& grid, const Run& run) {
  std::vector<TriangleSides> sides(mesh.triangles.size());
  parallel_ranges(static_cast<std::int64_t>(sides.size()), kSidesPerTask, run,
                  [&](std::int64_t begin, std::int64_t end) {
                    for (auto t = static_cast<std::size_t>(begin);
                         t < static_cast<std::size_t>(end); ++t) {
                      sides[t] = sides_of(mesh.corners(t), grid);
                    }
                  });
  return sides;
}

}  // namespace prefilter
