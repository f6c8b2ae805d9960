// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/voxels/contour/region_corners.h"

#include <algorithm>
#include <utility>

namespace prefilter {
namespace {

constexpr double kTurnCosine = 0.8660254037844387;  // 30 degrees
constexpr double kPointedShare = 0.75;              // length of the mean normal at a tip

struct BorderEnd {
  std::int32_t vertex;
  std::int32_t other;
  std::array<std::int32_t, 2> labels;
};
}  // namespace

std::vector<RegionCorner> border_corners(const FramedPositions& positions,
                                         const std::vector<RegionBorder>& borders) {
  std::vector<BorderEnd> ends;
  for (const RegionBorder& border : borders) {
    ends.push_back({border.ends[0], border.ends[1], border.labels});
    ends.push_back({border.ends[1], border.ends[0], border.labels});
  }
  std::stable_sort(ends.begin(), ends.end(),
                   [](const BorderEnd& a, const BorderEnd& b) { return a.vertex < b.vertex; });
  std::vector<RegionCorner> corners;
  for (std::size_t i = 0; i < ends.size();) {
    std::size_t end = i + 1;
    while (end < ends.size() && ends[end].vertex == ends[i].vertex) ++end;
    const std::int32_t vertex = ends[i].vertex;
    bool is_corner = end - i != 2;
    if (!is_corner) {
      const Vector3 u = direction_of(positions, vertex, ends[i].other);
      const Vector3 v = direction_of(positions, vertex, ends[i + 1].other);
      is_corner = -dot(u, v) < kTurnCosine;
    }
    if (is_corner) {
      RegionCorner corner{vertex, {}};
      for (std::size_t k = i; k < end; ++k) {
        corner.labels.insert(corner.labels.end(), ends[k].labels.begin(), ends[k].labels.end());
      }
      std::sort(corner.labels.begin(), corner.labels.end());
      corner.labels.erase(std::unique(corner.labels.begin(), corner.labels.end()),
                          corner.labels.end());
      corners.push_back(std::move(corner));
    }
    i = end;
  }
  return corners;
}

std::vector<RegionCorner> tips(const WeldedMeshes& welded, std::span<const std::int32_t> labels,
                               const std::vector<std::uint8_t>& is_on_wall,
                               const std::vector<float>& areas, double least) {
  std::vector<std::int32_t> candidates;
  for (std::size_t v = 0; v < is_on_wall.size(); ++v) {
    if (is_on_wall[v] == 0 && static_cast<double>(areas[v]) > least) {
      candidates.push_back(static_cast<std::int32_t>(v));
    }
  }
  std::vector<RegionCorner> found;
  if (candidates.empty()) return found;
  struct Around {
    Vector3 sum{};
    double area = 0.0;
    std::int32_t label = -1;
  };
  std::vector<Around> around(candidates.size());
  std::vector<std::int32_t> numbers(is_on_wall.size(), -1);
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    numbers[static_cast<std::size_t>(candidates[i])] = static_cast<std::int32_t>(i);
  }
  for (std::size_t t = 0; t < labels.size(); ++t) {
    for (const std::int32_t vertex : welded.triangle(t)) {
      const std::int32_t number = numbers[static_cast<std::size_t>(vertex)];
      if (number < 0) continue;
      Around& one = around[static_cast<std::size_t>(number)];
      const Vector3 half = 0.5 * welded.normal(t);
      one.sum = one.sum + half;
      one.area += length(half);
      one.label = std::max(one.label, labels[t]);
    }
  }
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    if (length(around[i].sum) < kPointedShare * around[i].area) {
      found.push_back({candidates[i], {around[i].label}});
    }
  }
  return found;
}

}  // namespace prefilter
