// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/solid/kept.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "prefilter/base/parallel.h"
#include "prefilter/voxel/queries.h"

namespace prefilter {
namespace {

constexpr std::int64_t kRowsPerTask = 1 << 12;
constexpr double kMarginCells = 3.0;
// Where leaves are looked up, in cells along the normal.
constexpr std::array<double, 5> kSteps = {0.0, -0.75, 0.75, -1.5, 1.5};
constexpr double kSampleCells = 2.0;

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

std::vector<float> kept_shares(const MeshView<std::int32_t>& mesh, const Octree& octree,
                               const Progress& progress, int threads) {
  const double cell = octree.cell_size(0, octree.depth);
  std::vector<float> shares(mesh.triangles.size(), 0.0F);
  parallel_ranges(
      static_cast<std::int64_t>(shares.size()), kRowsPerTask, threads, progress,
      [&](std::int64_t begin, std::int64_t end) {
        std::vector<Vector3> points;
        std::vector<std::size_t> starts;
        for (std::int64_t t = begin; t < end; ++t) {
          starts.push_back(points.size());
          const std::array<Vector3, 3> corners = mesh.corners(static_cast<std::size_t>(t));
          Vector3 normal = cross(corners[1] - corners[0], corners[2] - corners[0]);
          const double size = length(normal);
          if (size > 0.0) {
            for (double& x : normal) x *= cell / size;
          }
          for_samples(corners, kSampleCells * cell, [&](const Vector3& point) {
            for (const double step : kSteps) {
              points.push_back({point[0] + step * normal[0], point[1] + step * normal[1],
                                point[2] + step * normal[2]});
            }
          });
        }
        starts.push_back(points.size());
        const std::vector<float> values = values_at(octree, points, 1);
        for (std::int64_t t = begin; t < end; ++t) {
          const std::size_t first = starts[static_cast<std::size_t>(t - begin)];
          const std::size_t last = starts[static_cast<std::size_t>(t - begin) + 1];
          std::size_t kept = 0;
          for (std::size_t i = first; i < last; i += kSteps.size()) {
            const auto own = std::span(values).subspan(i, kSteps.size());
            const auto is_inside = [](float value) { return value >= 0.5F; };
            const auto inside = std::count_if(own.begin(), own.end(), is_inside);
            if (inside > 0 && inside < static_cast<std::ptrdiff_t>(kSteps.size())) ++kept;
          }
          shares[static_cast<std::size_t>(t)] =
              static_cast<float>(kept * kSteps.size()) /
              static_cast<float>(std::max<std::size_t>(last - first, 1));
        }
      });
  return shares;
}

}  // namespace prefilter
