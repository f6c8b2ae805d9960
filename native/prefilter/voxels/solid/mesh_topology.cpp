// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/voxels/mesh_topology.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <mutex>
#include <numeric>
#include <string>
#include <utility>

#include "prefilter/base/disjoint_sets.h"
#include "prefilter/base/error.h"
#include "prefilter/base/parallel.h"
#include "prefilter/voxels/solid/edge_hash.h"
#include "prefilter/voxels/solid/weld.h"

namespace prefilter {
namespace {

constexpr std::int64_t kFansPerTask = 1 << 13;
constexpr std::int64_t kTrianglesPerTask = 1 << 14;

using MeshTopologyCorners = std::array<std::uint32_t, 3>;

// Triangles in terms of welded vertices.
struct NamedTriangles {
  const TriangleView& triangles;
  const std::vector<std::int32_t>& names;  // welded vertex of each vertex; empty: no welding

  MeshTopologyCorners operator[](std::size_t t) const {
    MeshTopologyCorners corners;
    const auto triangle = triangles[t];
    for (std::size_t i = 0; i < 3; ++i) {
      const auto vertex = static_cast<std::size_t>(triangle[i]);
      corners[i] = static_cast<std::uint32_t>(
          names.empty() ? vertex : static_cast<std::size_t>(names[vertex]));
    }
    return corners;
  }
};

bool is_flat(const MeshTopologyCorners& corners) {
  const auto& [a, b, c] = corners;
  return a == b || b == c || c == a;
}

// Triangles at each vertex, except those with repeated vertices.
struct TrianglesAt {
  std::vector<std::uint32_t> starts;
  std::vector<std::uint32_t> triangles;

  TrianglesAt(const NamedTriangles& mesh, std::size_t vertices, const Run& run)
      : starts(vertices + 1, 0) {
    const auto next = [&](std::uint32_t vertex) {
      return std::atomic_ref(starts[vertex]).fetch_add(1, std::memory_order_relaxed);
    };
    const auto for_corners = [&](const Run& part, const auto& visit) {
      parallel_ranges(static_cast<std::int64_t>(mesh.triangles.size()), kTrianglesPerTask, part,
                      [&](std::int64_t begin, std::int64_t end) {
                        for (std::int64_t t = begin; t < end; ++t) {
                          const MeshTopologyCorners corners = mesh[static_cast<std::size_t>(t)];
                          if (is_flat(corners)) continue;
                          for (const std::uint32_t v : corners) {
                            visit(v, static_cast<std::uint32_t>(t));
                          }
                        }
                      });
    };
    const Stages stages(run, {2, 3});
    for_corners(stages[0], [&](std::uint32_t v, std::uint32_t) { next(v); });
    std::uint32_t sum = 0;
    for (std::uint32_t& start : starts) {
      sum += start;
      start = sum - start;
    }
    triangles.resize(sum);
    for_corners(stages[1], [&](std::uint32_t v, std::uint32_t t) { triangles[next(v)] = t; });
    // By now each entry holds the start of the next vertex.
    for (std::size_t v = vertices; v > 0; --v) starts[v] = starts[v - 1];
    starts[0] = 0;
  }
};

std::uint64_t edge_of(std::uint64_t v, std::uint64_t w) {
  return (std::min(v, w) << 32U) | std::max(v, w);
}

// Counts at vertices.
struct FanCounts {
  std::int64_t fans = 0;  // groups of triangles around a vertex connected by edges
  std::int64_t edges = 0;
  bool is_nonmanifold = false;                        // more than two triangles at an edge
  std::vector<std::array<std::uint64_t, 2>> borders;  // pairs of boundary edges at a fan's ends

  void add(FanCounts&& other) {
    fans += other.fans;
    edges += other.edges;
    is_nonmanifold = is_nonmanifold || other.is_nonmanifold;
    borders.insert(borders.end(), other.borders.begin(), other.borders.end());
  }
};

// Counts fans vertex by vertex, and joins the triangles at their edges.
class FanCounter {
 public:
  FanCounter(const NamedTriangles& mesh, DisjointSets<std::uint32_t>* parts)
      : mesh_(mesh), parts_(parts) {}

  FanCounts counts;

  void visit(std::uint32_t v, std::span<const std::uint32_t> triangles) {
    uses_.clear();
    fan_of_.resize(triangles.size());
    std::iota(fan_of_.begin(), fan_of_.end(), 0U);
    for (std::uint32_t i = 0; i < triangles.size(); ++i) {
      for (const std::uint32_t w : mesh_[triangles[i]]) {
        if (w != v) uses_.push_back((std::uint64_t{w} << 32U) | i);
      }
    }
    std::sort(uses_.begin(), uses_.end());
    borders_.clear();
    for (std::size_t i = 0; i < uses_.size();) {
      const auto w = static_cast<std::uint32_t>(uses_[i] >> 32U);
      const auto first = static_cast<std::uint32_t>(uses_[i]);
      std::size_t end = i + 1;
      for (; end < uses_.size() && uses_[end] >> 32U == w; ++end) {
        const auto other = static_cast<std::uint32_t>(uses_[end]);
        join(first, other);
        if (v < w) parts_->join_from_threads(triangles[first], triangles[other]);
      }
      if (v < w) ++counts.edges;
      counts.is_nonmanifold = counts.is_nonmanifold || end - i > 2;
      if (end - i == 1) borders_.push_back({first, edge_of(v, w)});
      i = end;
    }
    for (std::uint32_t i = 0; i < triangles.size(); ++i) counts.fans += fan_of_[i] == i ? 1 : 0;
    for (auto& [fan, edge] : borders_) fan = root(fan);
    std::sort(borders_.begin(), borders_.end());
    for (std::size_t i = 0; i < borders_.size(); ++i) {
      const bool is_next = i > 0 && borders_[i].first == borders_[i - 1].first;
      counts.borders.push_back({borders_[is_next ? i - 1 : i].second, borders_[i].second});
    }
  }

 private:
  std::uint32_t root(std::uint32_t i) const {
    while (fan_of_[i] != i) i = fan_of_[i];
    return i;
  }
  void join(std::uint32_t i, std::uint32_t j) {
    const std::uint32_t a = root(i);
    const std::uint32_t b = root(j);
    fan_of_[std::max(a, b)] = std::min(a, b);
    // Shortens paths, for vertices with many triangles.
    fan_of_[j] = fan_of_[i] = std::min(a, b);
  }

  NamedTriangles mesh_;
  DisjointSets<std::uint32_t>* parts_;
  std::vector<std::uint64_t> uses_;  // other end of an edge, index of the triangle here
  std::vector<std::uint32_t> fan_of_;
  std::vector<std::pair<std::uint32_t, std::uint64_t>> borders_;  // fan, edge
};

FanCounts count_all(const NamedTriangles& mesh, const TrianglesAt& at, const Run& run,
                    DisjointSets<std::uint32_t>* parts) {
  std::mutex mutex;
  FanCounts all;
  parallel_ranges(
      static_cast<std::int64_t>(at.starts.size()) - 1, kFansPerTask, run,
      [&](std::int64_t begin, std::int64_t end) {
        FanCounter fans(mesh, parts);
        for (auto v = static_cast<std::size_t>(begin); v < static_cast<std::size_t>(end); ++v) {
          const std::span all_triangles(at.triangles);
          fans.visit(static_cast<std::uint32_t>(v),
                     all_triangles.subspan(at.starts[v], at.starts[v + 1] - at.starts[v]));
        }
        const std::lock_guard lock(mutex);
        all.add(std::move(fans.counts));
      });
  return all;
}

// Unique boundary edges, sorted.
std::vector<std::uint64_t> border_edges(const FanCounts& counts) {
  std::vector<std::uint64_t> edges;
  edges.reserve(counts.borders.size());
  for (const auto& [one, other] : counts.borders) edges.push_back(other);
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  return edges;
}

// Number of loops that boundary edges form, connected by fans.
std::size_t count_loops(const std::vector<std::uint64_t>& edges, const FanCounts& counts) {
  DisjointSets<std::uint32_t> loops(edges.size());
  const auto number = [&](std::uint64_t edge) {
    return static_cast<std::uint32_t>(std::lower_bound(edges.begin(), edges.end(), edge) -
                                      edges.begin());
  };
  for (const auto& [one, other] : counts.borders) loops.join(number(one), number(other));
  std::uint32_t count = 0;
  loops.numbers(&count);
  return count;
}

// For each vertex the first boundary vertex at its position, or itself if it is not on a boundary.
// Empty if no two boundary vertices coincide.
std::vector<std::int32_t> welded_borders(const PositionView& positions, const FanCounts& counts,
                                         const Run& run) {
  std::vector<std::uint32_t> ends;
  for (const auto& [one, other] : counts.borders) {
    ends.push_back(static_cast<std::uint32_t>(other >> 32U));
    ends.push_back(static_cast<std::uint32_t>(other & 0xFFFFFFFFU));
  }
  std::sort(ends.begin(), ends.end());
  ends.erase(std::unique(ends.begin(), ends.end()), ends.end());
  std::vector<Vector3> places;
  places.reserve(ends.size());
  for (const std::uint32_t v : ends) places.push_back(positions[v]);
  const std::vector<std::int32_t> firsts = first_at_position(places, run);
  bool is_same = true;
  for (std::size_t i = 0; i < firsts.size(); ++i) {
    is_same = is_same && firsts[i] == static_cast<std::int32_t>(i);
  }
  if (is_same) return {};
  std::vector<std::int32_t> names(positions.size());
  std::iota(names.begin(), names.end(), 0);
  for (std::size_t i = 0; i < ends.size(); ++i) {
    names[ends[i]] = static_cast<std::int32_t>(ends[static_cast<std::size_t>(firsts[i])]);
  }
  return names;
}

// Number of parts that are closed, consistently oriented and inside out.
std::size_t count_cavities(const InputMesh& mesh, const NamedTriangles& named,
                           const MeshTopology& topology) {
  constexpr double kMinVolumeRatio = 1e-9;  // relative to area^(3/2); sheets have no volume
  struct Part {
    EdgeHash edges;
    Vector3 origin{};
    double volume = 0.0;
    double area = 0.0;
  };
  std::vector<Part> parts(topology.parts);
  double size = 0.0;
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    const Vector3 p = mesh.positions[v];
    for (const double x : p) size = std::max(size, std::abs(x));
  }
  for (std::size_t t = 0; t < topology.part_of.size(); ++t) {
    if (topology.part_of[t] < 0) continue;
    Part& part = parts[static_cast<std::size_t>(topology.part_of[t])];
    const auto [a, b, c] = named[t];
    part.edges += EdgeHash::of(a, b, c);
    std::array<Vector3, 3> p = mesh.corners(t);
    if (part.area == 0.0) part.origin = p[0];
    for (Vector3& corner : p) {
      for (std::size_t i = 0; i < 3; ++i) corner[i] = (corner[i] - part.origin[i]) / size;
    }
    part.volume += dot(p[0], cross(p[1], p[2])) / 6.0;
    part.area += length(cross(p[1] - p[0], p[2] - p[0])) / 2.0;
  }
  return static_cast<std::size_t>(std::count_if(parts.begin(), parts.end(), [](const Part& part) {
    return part.edges.is_zero() &&
           part.volume < -kMinVolumeRatio * part.area * std::sqrt(part.area);
  }));
}

MeshTopology topology_of(const NamedTriangles& mesh, const FanCounts& counts,
                         DisjointSets<std::uint32_t>&& parts) {
  MeshTopology result;
  const std::vector<std::uint32_t> roots = std::move(parts).roots();
  result.part_of.assign(roots.size(), -1);
  std::int64_t faces = 0;
  for (std::size_t t = 0; t < roots.size(); ++t) {
    if (is_flat(mesh[t])) continue;
    // The root is the lowest triangle of its part.
    const bool is_first = roots[t] == t;
    result.part_of[t] =
        is_first ? static_cast<std::int32_t>(result.parts++) : result.part_of[roots[t]];
    ++faces;
  }
  const std::vector<std::uint64_t> edges = border_edges(counts);
  result.borders = count_loops(edges, counts);
  for (const std::uint64_t edge : edges) {
    result.border_edges.push_back(
        {static_cast<std::int32_t>(edge >> 32U), static_cast<std::int32_t>(edge & 0xFFFFFFFFU)});
  }
  const std::int64_t euler = counts.fans - counts.edges + faces;
  const std::int64_t twice = 2 * static_cast<std::int64_t>(result.parts) -
                             static_cast<std::int64_t>(result.borders) - euler;
  if (!counts.is_nonmanifold && twice % 2 == 0) result.genus = static_cast<std::size_t>(twice / 2);
  return result;
}

}  // namespace

MeshTopology mesh_topology(const InputMesh& mesh, bool welds, const Run& run) {
  check_mesh(mesh, kLargestCoordinate);
  const std::size_t count = mesh.triangles.size();
  if (3 * count > std::numeric_limits<std::int32_t>::max()) {
    throw_invalid("triangles: found " + std::to_string(count) + "; at most 715827882 are allowed");
  }
  std::vector<std::int32_t> names;
  const auto counted = [&](DisjointSets<std::uint32_t>* parts, const Run& part) {
    const NamedTriangles named = {mesh.triangles, names};
    const Stages stages(part, {1, 1});
    const TrianglesAt at(named, mesh.positions.size(), stages[0]);
    return count_all(named, at, stages[1], parts);
  };
  DisjointSets<std::uint32_t> parts(count);
  FanCounts counts = counted(&parts, run.part(0.0, 0.5));
  if (welds && !counts.borders.empty()) {
    names = welded_borders(mesh.positions, counts, run.part(0.5, 0.6));
    if (!names.empty()) {
      parts = DisjointSets<std::uint32_t>(count);
      counts = counted(&parts, run.part(0.6, 0.9));
    }
  }
  const NamedTriangles named = {mesh.triangles, names};
  MeshTopology result = topology_of(named, counts, std::move(parts));
  result.cavities = count_cavities(mesh, named, result);
  run.report(1.0);
  return result;
}

}  // namespace prefilter
