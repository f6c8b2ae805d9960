// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/voxels/contour/smooth_regions.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numeric>
#include <optional>

#include "prefilter/base/disjoint_sets.h"
#include "prefilter/base/parallel.h"
#include "prefilter/base/sort.h"
#include "prefilter/voxels/contour/wide_facets.h"

namespace prefilter {
namespace {

constexpr std::int64_t kSidesPerSweep = 1 << 21;
constexpr std::int64_t kMostSweeps = 16;
constexpr double kPlaneCosine = 0.9998476951563913;  // 1 degree
constexpr double kLeastTurn = 2.0 / 15.0;            // 7.6 degrees, in radians

using Triangle = std::array<std::int32_t, 3>;

// A side of a triangle, stored at its lower vertex; `half` is three times the triangle plus the
// corner where it begins.
struct SmoothRegionsSide {
  std::uint32_t other;  // the higher vertex
  std::uint32_t half;

  bool operator<(const SmoothRegionsSide& side) const {
    return other != side.other ? other < side.other : half < side.half;
  }
};

// The sides of a range of lower vertices, grouped by vertex; `ends` holds the end of each group.
struct SideRows {
  std::vector<SmoothRegionsSide> sides;
  std::vector<std::uint32_t> ends;
};

SideRows gather_sides(const WeldedMeshes& welded, std::size_t first, std::size_t end) {
  SideRows rows;
  rows.ends.assign(end - first + 1, 0);
  const auto for_sides = [&](const auto& take) {
    for (std::size_t t = 0; t < welded.triangle_count(); ++t) {
      const Triangle corners = welded.triangle(t);
      for (std::size_t i = 0; i < 3; ++i) {
        const auto [low, high] = std::minmax(corners[i], corners[(i + 1) % 3]);
        const auto lower = static_cast<std::size_t>(low);
        if (low == high || lower < first || lower >= end) continue;
        take(lower - first, SmoothRegionsSide{static_cast<std::uint32_t>(high),
                                              static_cast<std::uint32_t>(3 * t + i)});
      }
    }
  };
  for_sides([&](std::size_t row, const SmoothRegionsSide&) { ++rows.ends[row + 1]; });
  std::partial_sum(rows.ends.begin(), rows.ends.end(), rows.ends.begin());
  rows.sides.resize(rows.ends.back());
  // Each row's begin moves to its end, where the next row begins.
  for_sides(
      [&](std::size_t row, const SmoothRegionsSide& side) { rows.sides[rows.ends[row]++] = side; });
  rows.ends.pop_back();
  return rows;
}

// Calls visit(sweep, low, sides) for the sides of every edge. Each sweep covers a range of lower
// vertices in order; sweeps run in parallel.
template <typename Visit>
void for_edges(const WeldedMeshes& welded, std::int64_t sweeps, const Run& run,
               const Visit& visit) {
  const std::size_t vertices = welded.positions.size();
  parallel_for(sweeps, run, [&](std::int64_t sweep) {
    const std::size_t first = vertices * static_cast<std::size_t>(sweep) / sweeps;
    const std::size_t end = vertices * static_cast<std::size_t>(sweep + 1) / sweeps;
    SideRows rows = gather_sides(welded, first, end);
    std::size_t begin = 0;
    for (std::size_t row = 0; row < rows.ends.size(); ++row) {
      const std::size_t row_end = rows.ends[row];
      std::sort(rows.sides.begin() + static_cast<std::ptrdiff_t>(begin),
                rows.sides.begin() + static_cast<std::ptrdiff_t>(row_end));
      while (begin < row_end) {
        std::size_t next = begin + 1;
        while (next < row_end && rows.sides[next].other == rows.sides[begin].other) ++next;
        visit(static_cast<std::size_t>(sweep), static_cast<std::int32_t>(first + row),
              std::span<const SmoothRegionsSide>(rows.sides).subspan(begin, next - begin));
        begin = next;
      }
    }
  });
}

bool runs_up(const WeldedMeshes& welded, const SmoothRegionsSide& side) {
  const Triangle corners = welded.triangle(side.half / 3);
  return corners[side.half % 3] < corners[(side.half + 1) % 3];
}

using Sets = DisjointSets<std::int32_t>;

// Two triangles at an edge that belongs to no other triangle.
struct Neighbors {
  std::array<std::int32_t, 2> ends;
  std::array<std::int32_t, 2> triangles;
  double cosine;  // between their normals
  bool is_of_one_group;

  bool is_smooth() const { return is_of_one_group && cosine >= kSharpCosine; }
  bool is_plane() const { return is_of_one_group && cosine >= kPlaneCosine; }
};

// Calls visit(sweep, neighbors) from several threads; returns whether some edges have a single
// side.
template <typename Visit>
bool for_neighbors(const WeldedMeshes& welded, std::int64_t sweeps, const Run& run,
                   const Visit& visit) {
  std::atomic<bool> has_single = false;
  for_edges(welded, sweeps, run,
            [&](std::size_t sweep, std::int32_t low, std::span<const SmoothRegionsSide> sides) {
              if (sides.size() == 1) has_single = true;
              if (sides.size() != 2 || runs_up(welded, sides[0]) == runs_up(welded, sides[1])) {
                return;
              }
              const std::size_t t = sides[0].half / 3;
              const std::size_t u = sides[1].half / 3;
              const Vector3 of_t = welded.normal(t);
              const Vector3 of_u = welded.normal(u);
              const double sizes = std::sqrt(dot(of_t, of_t) * dot(of_u, of_u));
              if (!(sizes > 0.0)) return;
              visit(sweep, Neighbors{{low, static_cast<std::int32_t>(sides[0].other)},
                                     {static_cast<std::int32_t>(t), static_cast<std::int32_t>(u)},
                                     dot(of_t, of_u) / sizes,
                                     welded.meshes.group(t) == welded.meshes.group(u)});
            });
  return has_single;
}

// Joins triangles where is_joined(neighbors) holds; other edges are walls. Returns as for_neighbors
// does.
template <typename IsJoined>
bool join_regions(const WeldedMeshes& welded, const IsJoined& is_joined, const Run& run,
                  SmoothRegions* found) {
  Sets regions(welded.triangle_count());
  const auto rows = static_cast<std::int64_t>(3 * welded.triangle_count());
  const std::int64_t sweeps = std::min(range_count(rows, kSidesPerSweep), kMostSweeps);
  std::vector<std::vector<Wall>> walls(static_cast<std::size_t>(sweeps));
  const auto join = [&](std::size_t sweep, const Neighbors& both) {
    if (is_joined(both)) {
      regions.join_from_threads(both.triangles[0], both.triangles[1]);
    } else {
      walls[sweep].push_back({both.ends, both.triangles, both.is_smooth()});
    }
  };
  const bool has_single = for_neighbors(welded, sweeps, run, join);
  found->walls.clear();
  for (std::vector<Wall>& some : walls) {
    found->walls.insert(found->walls.end(), some.begin(), some.end());
    some = {};
  }
  found->labels = regions.numbers(&found->region_count);
  return has_single;
}

// None if some edges have a single side, unless `may_have_single`.
std::optional<SmoothRegions> try_to_join(const WeldedMeshes& welded, double least_width,
                                         bool may_have_single, const Run& run) {
  const std::size_t count = welded.triangle_count();
  Sets parts(count);
  Sets facets(count);
  SmoothRegions found;
  const auto is_smooth = [&](const Neighbors& both) {
    parts.join_from_threads(both.triangles[0], both.triangles[1]);
    if (both.is_plane()) facets.join_from_threads(both.triangles[0], both.triangles[1]);
    return both.is_smooth();
  };
  const Stages stages(run, {3, 2});
  const bool has_single = join_regions(welded, is_smooth, stages[0], &found);
  if (has_single && !may_have_single) return std::nullopt;
  found.parts = parts.numbers(&found.part_count);
  int facet_count = 0;
  const std::vector<std::int32_t> facet_of = facets.numbers(&facet_count);
  const std::vector<double> widths = wide_facets(welded, facet_of, facet_count, least_width);
  if (widths.empty()) return found;
  // The deviation of a rounded edge grows with the width of facets and with the angle.
  const auto is_beside_none = [&](const Neighbors& both) {
    const auto t = static_cast<std::size_t>(both.triangles[0]);
    const auto u = static_cast<std::size_t>(both.triangles[1]);
    const double turn = std::sqrt(2.0 * std::max(0.0, 1.0 - both.cosine));
    const double width = std::max(widths[t], widths[u]);
    return both.is_smooth() &&
           (facet_of[t] == facet_of[u] || width * turn < kLeastTurn * least_width);
  };
  join_regions(welded, is_beside_none, stages[1], &found);
  return found;
}
}  // namespace

std::vector<std::int32_t> first_places(const FramedPositions& positions, const Run& run) {
  std::vector<std::int32_t> order(positions.size());
  std::iota(order.begin(), order.end(), 0);
  const auto less = [&](std::int32_t a, std::int32_t b) {
    const Vector3 p = positions[static_cast<std::size_t>(a)];
    const Vector3 q = positions[static_cast<std::size_t>(b)];
    return p != q ? p < q : a < b;
  };
  sort_in_parallel(&order, run, less);
  std::vector<std::int32_t> firsts(order.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    const auto v = static_cast<std::size_t>(order[i]);
    const bool is_same = i > 0 && positions[v] == positions[static_cast<std::size_t>(order[i - 1])];
    firsts[v] = is_same ? firsts[static_cast<std::size_t>(order[i - 1])] : order[i];
  }
  return firsts;
}

SmoothRegions join_smooth(double least_width, const Run& run, WeldedMeshes* welded) {
  const Stages stages(run, {5, 1, 4});
  std::optional<SmoothRegions> found = try_to_join(*welded, least_width, false, stages[0]);
  if (!found) {
    welded->firsts = first_places(welded->positions, stages[1]);
    found = try_to_join(*welded, least_width, true, stages[2]);
  }
  return std::move(*found);
}

}  // namespace prefilter
