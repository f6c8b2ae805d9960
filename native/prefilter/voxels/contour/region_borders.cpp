// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/voxels/contour/region_borders.h"

#include <algorithm>
#include <cmath>

#include "prefilter/base/disjoint_sets.h"
#include "prefilter/base/elementary.h"

namespace prefilter {
namespace {

constexpr std::size_t kRowsPerReport = 1 << 14;
constexpr double kStraight = 0.5176380902050415;  // twice the sine of 15 degrees
// A chain of edges is roughness if it turns or branches this often, and is this blunt.
constexpr double kRoughCells = 12.0;
constexpr int kRoughEdges = 4;
constexpr double kRoughAngle = 0.6981317007977318;  // 40 degrees, on average
constexpr double kLeastRidge = 8.0;                 // cells

using Sets = DisjointSets<std::int32_t>;

struct Shared {
  std::int32_t small;
  std::int32_t other;
  double length;

  bool operator<(const Shared& b) const {
    if (small != b.small) return small < b.small;
    return other != b.other ? other < b.other : length < b.length;
  }
};

bool are_of_one_group(const WeldedMeshes& welded, const Wall& wall) {
  return welded.meshes.group(static_cast<std::size_t>(wall.triangles[0])) ==
         welded.meshes.group(static_cast<std::size_t>(wall.triangles[1]));
}

double length_of(const WeldedMeshes& welded, const std::array<std::int32_t, 2>& ends) {
  return length(welded.position(ends[0]) - welded.position(ends[1]));
}

std::array<std::int32_t, 2> labels_of(const std::vector<std::int32_t>& labels, const Wall& wall) {
  return {labels[static_cast<std::size_t>(wall.triangles[0])],
          labels[static_cast<std::size_t>(wall.triangles[1])]};
}

// For the sorted walls of small regions: joins each small region with the one it shares most with.
Sets joined_by_length(const std::vector<Shared>& shared, int region_count) {
  Sets joined(static_cast<std::size_t>(region_count));
  for (std::size_t i = 0; i < shared.size();) {
    const std::int32_t small = shared[i].small;
    std::int32_t best = small;
    double longest = -1.0;
    while (i < shared.size() && shared[i].small == small) {
      const std::int32_t other = shared[i].other;
      double sum = 0.0;
      for (; i < shared.size() && shared[i].small == small && shared[i].other == other; ++i) {
        sum += shared[i].length;
      }
      if (sum > longest) {
        longest = sum;
        best = other;
      }
    }
    joined.join(small, best);
  }
  return joined;
}

// Regions narrower than `narrow`: area / (perimeter / 2).
std::vector<std::uint8_t> narrow_regions(const WeldedMeshes& welded,
                                         const std::vector<double>& areas, double narrow,
                                         const SmoothRegions& regions) {
  std::vector<double> around(areas.size(), 0.0);
  for (const Wall& wall : regions.walls) {
    const auto labels = labels_of(regions.labels, wall);
    if (labels[0] == labels[1]) continue;
    const double size = length_of(welded, wall.ends);
    for (const std::int32_t label : labels) {
      if (label >= 0) around[static_cast<std::size_t>(label)] += size;
    }
  }
  std::vector<std::uint8_t> is_narrow(areas.size(), 0);
  for (std::size_t i = 0; i < areas.size(); ++i) {
    is_narrow[i] = 2.0 * areas[i] < narrow * around[i] ? 1 : 0;
  }
  return is_narrow;
}

// Properties of connected edges.
struct Chain {
  double cells = 0.0;
  double angles = 0.0;
  int edges = 0;
  int rough = 0;  // vertices where edges turn, end or meet

  bool is_rough() const {
    return rough > 2 + edges / kRoughEdges && cells < kRoughCells * rough &&
           angles < kRoughAngle * edges;
  }
};

double angle_between(const WeldedMeshes& welded, const std::array<std::int32_t, 2>& triangles) {
  const Vector3 a = welded.normal(static_cast<std::size_t>(triangles[0]));
  const Vector3 b = welded.normal(static_cast<std::size_t>(triangles[1]));
  return elementary::atan2(length(cross(a, b)), dot(a, b));
}

// Flags vertices where edges turn by 30 degrees, end or meet.
std::vector<std::int32_t> rough_vertices(const WeldedMeshes& welded,
                                         const std::vector<RegionBorder>& borders) {
  struct Meeting {
    Vector3 sum{};  // sum of the directions of edges that end there
    int edges = 0;
  };
  std::vector<Meeting> meetings(welded.positions.size());
  for (const RegionBorder& border : borders) {
    const Vector3 along = direction_of(welded.positions, border.ends[0], border.ends[1]);
    for (int end = 0; end < 2; ++end) {
      Meeting& meeting = meetings[static_cast<std::size_t>(border.ends[end])];
      meeting.sum = end == 0 ? meeting.sum + along : meeting.sum - along;
      ++meeting.edges;
    }
  }
  std::vector<std::int32_t> rough;
  for (std::size_t v = 0; v < meetings.size(); ++v) {
    if (meetings[v].edges == 0) continue;
    if (meetings[v].edges == 2 && length(meetings[v].sum) < kStraight) continue;
    rough.push_back(static_cast<std::int32_t>(v));
  }
  return rough;
}
}  // namespace

RegionAreas measure_regions(const WeldedMeshes& welded, int region_count, const Run& run,
                            std::vector<std::int32_t>* labels) {
  RegionAreas areas;
  areas.regions.assign(static_cast<std::size_t>(region_count), 0.0);
  areas.vertices.assign(welded.positions.size(), 0.0F);
  const std::size_t count = welded.triangle_count();
  for (std::size_t t = 0; t < count; ++t) {
    if (t % kRowsPerReport == 0) {
      run.report(static_cast<double>(t) / static_cast<double>(count));
    }
    const Vector3 twice = welded.normal(t);
    const double area = std::sqrt(dot(twice, twice)) / 2.0;
    std::int32_t& label = (*labels)[t];
    areas.regions[static_cast<std::size_t>(label)] += area;
    if (!(area > 0.0)) label = -1;
    for (const std::int32_t vertex : welded.triangle(t)) {
      areas.vertices[static_cast<std::size_t>(vertex)] += static_cast<float>(area);
    }
  }
  return areas;
}

void join_small(const WeldedMeshes& welded, const std::vector<double>& areas, double least,
                double narrow, SmoothRegions* regions) {
  const std::vector<std::uint8_t> is_narrow = narrow_regions(welded, areas, narrow, *regions);
  std::vector<Shared> shared;
  for (const Wall& wall : regions->walls) {
    const auto [p, q] = labels_of(regions->labels, wall);
    if (p == q || p < 0 || q < 0 || !are_of_one_group(welded, wall)) continue;
    const double size = length_of(welded, wall.ends);
    const auto is_small = [&](std::int32_t label) {
      const auto region = static_cast<std::size_t>(label);
      return areas[region] < least || (wall.is_crease && is_narrow[region] != 0);
    };
    if (is_small(p)) shared.push_back({p, q, size});
    if (is_small(q)) shared.push_back({q, p, size});
  }
  if (shared.empty()) return;
  std::sort(shared.begin(), shared.end());
  const std::vector<std::int32_t> numbers =
      joined_by_length(shared, regions->region_count).numbers(&regions->region_count);
  for (std::int32_t& label : regions->labels) {
    if (label >= 0) label = numbers[static_cast<std::size_t>(label)];
  }
}

std::vector<std::uint8_t> are_smooth(const WeldedMeshes& welded,
                                     const std::vector<RegionBorder>& borders, double least,
                                     double cell) {
  std::vector<std::uint8_t> result(borders.size(), 0);
  if (borders.empty()) return result;
  Sets chains(welded.positions.size());
  for (const RegionBorder& border : borders) chains.join(border.ends[0], border.ends[1]);
  std::vector<Chain> sums(welded.positions.size());
  const auto chain_of = [&](std::int32_t vertex) -> Chain& {
    return sums[static_cast<std::size_t>(chains.root(vertex))];
  };
  for (const RegionBorder& border : borders) {
    Chain& chain = chain_of(border.ends[0]);
    chain.angles += angle_between(welded, border.triangles);
    ++chain.edges;
    chain.cells += length_of(welded, border.ends) / cell;
  }
  for (const std::int32_t vertex : rough_vertices(welded, borders)) ++chain_of(vertex).rough;
  for (std::size_t i = 0; i < borders.size(); ++i) {
    const Chain& chain = chain_of(borders[i].ends[0]);
    result[i] = chain.cells >= least && !chain.is_rough() ? 1 : 0;
  }
  return result;
}

std::vector<RegionBorder> find_borders(const WeldedMeshes& welded, double cell,
                                       SmoothRegions* regions) {
  std::vector<RegionBorder> borders;
  std::vector<RegionBorder> within;
  std::vector<RegionBorder> between;
  std::vector<RegionBorder> creases;
  for (const Wall& wall : regions->walls) {
    const auto [p, q] = labels_of(regions->labels, wall);
    if (wall.is_crease && p == q) continue;
    const bool is_of_groups = p != q && !are_of_one_group(welded, wall);
    (is_of_groups     ? borders
     : wall.is_crease ? creases
     : p != q         ? between
                      : within)
        .push_back({wall.ends, {p, q}, wall.triangles});
  }
  regions->walls = {};
  const std::vector<std::uint8_t> is_ridge = are_smooth(welded, within, kLeastRidge, cell);
  for (std::size_t i = 0; i < within.size(); ++i) {
    if (is_ridge[i] != 0) borders.push_back(within[i]);
  }
  const std::vector<std::uint8_t> is_border = are_smooth(welded, between, 0.0, cell);
  Sets joined(static_cast<std::size_t>(regions->region_count));
  for (std::size_t i = 0; i < between.size(); ++i) {
    if (is_border[i] != 0) {
      borders.push_back(between[i]);
    } else {
      joined.join(between[i].labels[0], between[i].labels[1]);
    }
  }
  const std::vector<std::int32_t> numbers = joined.numbers(&regions->region_count);
  for (std::int32_t& label : regions->labels) {
    if (label >= 0) label = numbers[static_cast<std::size_t>(label)];
  }
  const std::size_t sharp = borders.size();
  borders.insert(borders.end(), creases.begin(), creases.end());
  for (RegionBorder& border : borders) {
    for (std::int32_t& label : border.labels) label = numbers[static_cast<std::size_t>(label)];
  }
  // Edges within a region are only kept where they are sharp.
  borders.erase(std::remove_if(borders.begin() + static_cast<std::ptrdiff_t>(sharp), borders.end(),
                               [](const RegionBorder& border) {
                                 return border.labels[0] == border.labels[1];
                               }),
                borders.end());
  return borders;
}

}  // namespace prefilter
