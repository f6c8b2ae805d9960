// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/contour/source_regions.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <numeric>
#include <string>
#include <utility>

#include "prefilter/base/disjoint_sets.h"
#include "prefilter/base/elementary.h"
#include "prefilter/base/error.h"
#include "prefilter/base/parallel.h"
#include "prefilter/base/sort.h"

namespace prefilter {
namespace {

constexpr std::int64_t kRowsPerTask = 1 << 14;
constexpr std::int64_t kSidesPerSweep = 1 << 21;
constexpr std::int64_t kMostSweeps = 16;
constexpr double kTurnCosine = 0.8660254037844387;  // 30 degrees: of a border at a corner
constexpr double kPointedShare = 0.75;              // of a mean normal's length, at a tip
constexpr double kLeastRegion = 4.0;                // of a cell's face
constexpr double kStraight = 0.5176380902050415;    // twice the sine of 15 degrees
// A chain of edges is roughness where it turns or parts this often, and they are this blunt.
constexpr double kRoughCells = 12.0;
constexpr int kRoughEdges = 4;
constexpr double kRoughAngle = 0.6981317007977318;  // 40 degrees, on average
constexpr double kLeastRidge = 8.0;                 // cells
constexpr double kLargest = 1e150;

using Triangle = std::array<std::int32_t, 3>;
using Sets = DisjointSets<std::int32_t>;

// A side of a triangle, as its lower vertex keeps it; `half` is three times the triangle plus the
// corner where it begins.
struct Side {
  std::uint32_t other;  // the higher vertex
  std::uint32_t half;

  bool operator<(const Side& side) const {
    return other != side.other ? other < side.other : half < side.half;
  }
};

// Two triangles that meet at an edge of theirs alone, and are not of one smooth surface.
struct Wall {
  std::array<std::int32_t, 2> ends;  // the lower vertex first
  std::array<std::int32_t, 2> triangles;
};

class RegionFinder {
 public:
  RegionFinder(std::span<const SourceMesh> sources, const RootFrame& frame, double cell,
               int threads)
      : cell_(cell),
        threads_(threads),
        meshes_(sources),
        found_{FramedPositions(meshes_, frame), JoinedTriangles(meshes_), {}, {}, {}, {}, 0},
        count_(meshes_.triangle_count()) {}

  SourceRegions find(const Progress& progress) {
    join_smooth(progress.part(0.0, 0.7));
    measure(progress.part(0.7, 0.85));
    join_small();
    progress.report(0.9);
    find_borders();
    find_corners();
    progress.report(1.0);
    return std::move(found_);
  }

 private:
  // The vertices of a triangle, with one for each place if that is needed.
  Triangle places(std::size_t t) const {
    Triangle triangle = found_.triangles[t];
    if (!firsts_.empty()) {
      for (std::int32_t& vertex : triangle) vertex = firsts_[static_cast<std::size_t>(vertex)];
    }
    return triangle;
  }

  // As long as twice the area.
  Vector3 normal(std::size_t t) const {
    const Vector3 a = found_.corner(t, 0);
    return cross(found_.corner(t, 1) - a, found_.corner(t, 2) - a);
  }

  // Calls visit(sweep, low, sides) for the sides of every edge, in order within a sweep, which is
  // of a range of lower vertices; sweeps are in parallel.
  template <typename Visit>
  void for_edges(std::int64_t sweeps, const Progress& progress, const Visit& visit) const {
    const std::size_t vertices = found_.positions.size();
    parallel_for(sweeps, threads_, progress, [&](std::int64_t sweep) {
      const std::size_t first = vertices * static_cast<std::size_t>(sweep) / sweeps;
      const std::size_t end = vertices * static_cast<std::size_t>(sweep + 1) / sweeps;
      std::vector<std::uint32_t> ends(end - first + 1, 0);
      const auto for_sides = [&](const auto& take) {
        for (std::size_t t = 0; t < count_; ++t) {
          const Triangle corners = places(t);
          for (std::size_t i = 0; i < 3; ++i) {
            const auto [low, high] = std::minmax(corners[i], corners[(i + 1) % 3]);
            const auto lower = static_cast<std::size_t>(low);
            if (low == high || lower < first || lower >= end) continue;
            take(lower - first,
                 Side{static_cast<std::uint32_t>(high), static_cast<std::uint32_t>(3 * t + i)});
          }
        }
      };
      for_sides([&](std::size_t row, const Side&) { ++ends[row + 1]; });
      std::partial_sum(ends.begin(), ends.end(), ends.begin());
      std::vector<Side> sides(ends.back());
      // Each row's begin moves to its end, which is where the next one begins.
      for_sides([&](std::size_t row, const Side& side) { sides[ends[row]++] = side; });
      std::size_t begin = 0;
      for (std::size_t row = 0; row + 1 < ends.size(); ++row) {
        const std::size_t row_end = ends[row];
        std::sort(sides.begin() + static_cast<std::ptrdiff_t>(begin),
                  sides.begin() + static_cast<std::ptrdiff_t>(row_end));
        while (begin < row_end) {
          std::size_t next = begin + 1;
          while (next < row_end && sides[next].other == sides[begin].other) ++next;
          visit(static_cast<std::size_t>(sweep), static_cast<std::int32_t>(first + row),
                std::span<const Side>(sides).subspan(begin, next - begin));
          begin = next;
        }
      }
    });
  }

  bool runs_up(const Side& side) const {
    const Triangle corners = places(side.half / 3);
    return corners[side.half % 3] < corners[(side.half + 1) % 3];
  }

  // Where some edges have one side alone, vertices at one place become one first.
  void join_smooth(const Progress& progress) {
    if (join_smooth_once(progress.part(0.0, 0.5))) return;
    weld(progress.part(0.5, 0.6));
    join_smooth_once(progress.part(0.6, 1.0));
  }

  // Returns whether no edge has one side alone.
  bool join_smooth_once(const Progress& progress) {
    Sets regions(count_);
    Sets parts(count_);
    const auto rows = static_cast<std::int64_t>(3 * count_);
    const std::int64_t sweeps = std::min(range_count(rows, kSidesPerSweep), kMostSweeps);
    std::vector<std::vector<Wall>> walls(static_cast<std::size_t>(sweeps));
    std::atomic<bool> has_single = false;
    const auto join = [&](std::size_t sweep, std::int32_t low, std::span<const Side> sides) {
      if (sides.size() == 1) has_single = true;
      if (sides.size() != 2 || runs_up(sides[0]) == runs_up(sides[1])) return;
      const std::size_t t = sides[0].half / 3;
      const std::size_t u = sides[1].half / 3;
      const Vector3 of_t = normal(t);
      const Vector3 of_u = normal(u);
      const double sizes = std::sqrt(dot(of_t, of_t) * dot(of_u, of_u));
      if (!(sizes > 0.0)) return;
      const std::array<std::int32_t, 2> both = {static_cast<std::int32_t>(t),
                                                static_cast<std::int32_t>(u)};
      parts.join_from_threads(both[0], both[1]);
      if (dot(of_t, of_u) >= kSharpCosine * sizes && meshes_.group(t) == meshes_.group(u)) {
        regions.join_from_threads(both[0], both[1]);
      } else {
        walls[sweep].push_back({{low, static_cast<std::int32_t>(sides[0].other)}, both});
      }
    };
    for_edges(sweeps, progress, join);
    if (has_single && firsts_.empty()) return false;
    walls_.clear();
    for (std::vector<Wall>& some : walls) {
      walls_.insert(walls_.end(), some.begin(), some.end());
      some = {};
    }
    found_.labels = regions.numbers(&region_count_);
    found_.parts = parts.numbers(&found_.part_count);
    return true;
  }

  void weld(const Progress& progress) {
    const FramedPositions& positions = found_.positions;
    std::vector<std::int32_t> order(positions.size());
    std::iota(order.begin(), order.end(), 0);
    const auto less = [&](std::int32_t a, std::int32_t b) {
      const Vector3 p = positions[static_cast<std::size_t>(a)];
      const Vector3 q = positions[static_cast<std::size_t>(b)];
      return p != q ? p < q : a < b;
    };
    sort_in_parallel(&order, progress, threads_, less);
    firsts_.resize(order.size());
    for (std::size_t i = 0; i < order.size(); ++i) {
      const auto v = static_cast<std::size_t>(order[i]);
      const bool is_same =
          i > 0 && positions[v] == positions[static_cast<std::size_t>(order[i - 1])];
      firsts_[v] = is_same ? firsts_[static_cast<std::size_t>(order[i - 1])] : order[i];
    }
  }

  // The areas of regions and around vertices.
  void measure(const Progress& progress) {
    region_areas_.assign(static_cast<std::size_t>(region_count_), 0.0);
    vertex_areas_.assign(found_.positions.size(), 0.0F);
    for (std::size_t t = 0; t < count_; ++t) {
      if (t % kRowsPerTask == 0) {
        progress.report(static_cast<double>(t) / static_cast<double>(count_));
      }
      const Vector3 twice = normal(t);
      const double area = std::sqrt(dot(twice, twice)) / 2.0;
      std::int32_t& label = found_.labels[t];
      region_areas_[static_cast<std::size_t>(label)] += area;
      if (!(area > 0.0)) label = -1;
      for (const std::int32_t vertex : places(t)) {
        vertex_areas_[static_cast<std::size_t>(vertex)] += static_cast<float>(area);
      }
    }
  }

  struct Shared {
    std::int32_t small;
    std::int32_t other;
    double length;
  };

  void join_small() {
    const auto is_small = [&](std::int32_t label) {
      return region_areas_[static_cast<std::size_t>(label)] < kLeastRegion * cell_ * cell_;
    };
    std::vector<Shared> shared;
    for (const Wall& wall : walls_) {
      const std::int32_t p = label_of(wall, 0);
      const std::int32_t q = label_of(wall, 1);
      if (p == q || group_of(wall, 0) != group_of(wall, 1)) continue;
      const double size = wall_length(wall);
      if (is_small(p)) shared.push_back({p, q, size});
      if (is_small(q)) shared.push_back({q, p, size});
    }
    if (shared.empty()) return;
    std::sort(shared.begin(), shared.end(), [](const Shared& a, const Shared& b) {
      if (a.small != b.small) return a.small < b.small;
      return a.other != b.other ? a.other < b.other : a.length < b.length;
    });
    Sets joined(static_cast<std::size_t>(region_count_));
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
    const std::vector<std::int32_t> numbers = joined.numbers(&region_count_);
    for (std::int32_t& label : found_.labels) {
      if (label >= 0) label = numbers[static_cast<std::size_t>(label)];
    }
  }

  std::int32_t label_of(const Wall& wall, std::size_t side) const {
    return found_.labels[static_cast<std::size_t>(wall.triangles[side])];
  }
  std::int32_t group_of(const Wall& wall, std::size_t side) const {
    return meshes_.group(static_cast<std::size_t>(wall.triangles[side]));
  }
  double wall_length(const Wall& wall) const {
    return length(found_.positions[static_cast<std::size_t>(wall.ends[0])] -
                  found_.positions[static_cast<std::size_t>(wall.ends[1])]);
  }

  void find_borders() {
    std::vector<RegionBorder> within;
    std::vector<RegionBorder> between;
    on_wall_.assign(found_.positions.size(), 0);
    for (const Wall& wall : walls_) {
      for (const std::int32_t end : wall.ends) on_wall_[static_cast<std::size_t>(end)] = 1;
      const std::int32_t p = label_of(wall, 0);
      const std::int32_t q = label_of(wall, 1);
      if (p != q && group_of(wall, 0) != group_of(wall, 1)) {
        found_.borders.push_back({wall.ends, {p, q}, wall.triangles});
      } else {
        (p != q ? between : within).push_back({wall.ends, {p, q}, wall.triangles});
      }
    }
    walls_ = {};
    const std::vector<std::uint8_t> is_ridge = are_smooth(within, kLeastRidge);
    for (std::size_t i = 0; i < within.size(); ++i) {
      if (is_ridge[i] != 0) found_.borders.push_back(within[i]);
    }
    const std::vector<std::uint8_t> is_border = are_smooth(between, 0.0);
    Sets joined(static_cast<std::size_t>(region_count_));
    bool has_joined = false;
    for (std::size_t i = 0; i < between.size(); ++i) {
      if (is_border[i] != 0) {
        found_.borders.push_back(between[i]);
      } else {
        joined.join(between[i].labels[0], between[i].labels[1]);
        has_joined = true;
      }
    }
    if (!has_joined) return;
    const std::vector<std::int32_t> numbers = joined.numbers(&region_count_);
    for (std::int32_t& label : found_.labels) {
      if (label >= 0) label = numbers[static_cast<std::size_t>(label)];
    }
    for (RegionBorder& border : found_.borders) {
      for (std::int32_t& label : border.labels) label = numbers[static_cast<std::size_t>(label)];
    }
  }

  double angle_between(const std::array<std::int32_t, 2>& triangles) const {
    const Vector3 a = normal(static_cast<std::size_t>(triangles[0]));
    const Vector3 b = normal(static_cast<std::size_t>(triangles[1]));
    return elementary::atan2(length(cross(a, b)), dot(a, b));
  }

  // Of edges that hang together: whether they are `least` cells long, and no roughness: blunt, and
  // with many vertices where they turn, end or meet.
  std::vector<std::uint8_t> are_smooth(const std::vector<RegionBorder>& borders,
                                       double least) const {
    std::vector<std::uint8_t> result(borders.size(), 0);
    if (borders.empty()) return result;
    Sets chains(found_.positions.size());
    struct Meeting {
      Vector3 sum{};  // of the directions of the edges that end there
      int edges = 0;
    };
    std::vector<Meeting> meetings(found_.positions.size());
    for (const RegionBorder& border : borders) {
      chains.join(border.ends[0], border.ends[1]);
      const Vector3 along = direction(border.ends[0], border.ends[1]);
      for (int end = 0; end < 2; ++end) {
        Meeting& meeting = meetings[static_cast<std::size_t>(border.ends[end])];
        meeting.sum = end == 0 ? meeting.sum + along : meeting.sum - along;
        ++meeting.edges;
      }
    }
    struct Chain {
      double cells = 0.0;
      double angles = 0.0;
      int edges = 0;
      int rough = 0;
    };
    std::vector<Chain> sums(found_.positions.size());
    const auto chain_of = [&](std::int32_t vertex) -> Chain& {
      return sums[static_cast<std::size_t>(chains.root(vertex))];
    };
    for (const RegionBorder& border : borders) {
      Chain& chain = chain_of(border.ends[0]);
      chain.angles += angle_between(border.triangles);
      ++chain.edges;
      chain.cells += length(found_.positions[static_cast<std::size_t>(border.ends[0])] -
                            found_.positions[static_cast<std::size_t>(border.ends[1])]) /
                     cell_;
    }
    for (std::size_t v = 0; v < meetings.size(); ++v) {
      if (meetings[v].edges == 0) continue;
      if (meetings[v].edges == 2 && length(meetings[v].sum) < kStraight) continue;
      ++chain_of(static_cast<std::int32_t>(v)).rough;
    }
    for (std::size_t i = 0; i < borders.size(); ++i) {
      const Chain& chain = chain_of(borders[i].ends[0]);
      const bool is_rough = chain.rough > 2 + chain.edges / kRoughEdges &&
                            chain.cells < kRoughCells * chain.rough &&
                            chain.angles < kRoughAngle * chain.edges;
      result[i] = chain.cells >= least && !is_rough ? 1 : 0;
    }
    return result;
  }

  void find_corners() {
    struct End {
      std::int32_t vertex;
      std::int32_t other;
      std::array<std::int32_t, 2> labels;
    };
    std::vector<End> ends;
    for (const RegionBorder& border : found_.borders) {
      ends.push_back({border.ends[0], border.ends[1], border.labels});
      ends.push_back({border.ends[1], border.ends[0], border.labels});
    }
    std::stable_sort(ends.begin(), ends.end(),
                     [](const End& a, const End& b) { return a.vertex < b.vertex; });
    for (std::size_t i = 0; i < ends.size();) {
      std::size_t end = i + 1;
      while (end < ends.size() && ends[end].vertex == ends[i].vertex) ++end;
      const std::int32_t vertex = ends[i].vertex;
      bool is_corner = end - i != 2;
      if (!is_corner) {
        const Vector3 u = direction(vertex, ends[i].other);
        const Vector3 v = direction(vertex, ends[i + 1].other);
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
        found_.corners.push_back(std::move(corner));
      }
      i = end;
    }
    find_tips();
  }

  // Vertices without a border where the normals around differ much.
  void find_tips() {
    const double least = kLeastRegion * cell_ * cell_;
    std::vector<std::int32_t> candidates;
    for (std::size_t v = 0; v < on_wall_.size(); ++v) {
      if (on_wall_[v] == 0 && static_cast<double>(vertex_areas_[v]) > least) {
        candidates.push_back(static_cast<std::int32_t>(v));
      }
    }
    if (candidates.empty()) return;
    struct Around {
      Vector3 sum{};
      double area = 0.0;
      std::int32_t label = -1;
    };
    std::vector<Around> around(candidates.size());
    std::vector<std::int32_t> numbers(on_wall_.size(), -1);
    for (std::size_t i = 0; i < candidates.size(); ++i) {
      numbers[static_cast<std::size_t>(candidates[i])] = static_cast<std::int32_t>(i);
    }
    for (std::size_t t = 0; t < count_; ++t) {
      for (const std::int32_t vertex : places(t)) {
        const std::int32_t number = numbers[static_cast<std::size_t>(vertex)];
        if (number < 0) continue;
        Around& one = around[static_cast<std::size_t>(number)];
        const Vector3 half = 0.5 * normal(t);
        one.sum = one.sum + half;
        one.area += length(half);
        one.label = std::max(one.label, found_.labels[t]);
      }
    }
    for (std::size_t i = 0; i < candidates.size(); ++i) {
      if (length(around[i].sum) < kPointedShare * around[i].area) {
        found_.corners.push_back({candidates[i], {around[i].label}});
      }
    }
  }

  Vector3 direction(std::int32_t from, std::int32_t to) const {
    const Vector3 d = found_.positions[static_cast<std::size_t>(to)] -
                      found_.positions[static_cast<std::size_t>(from)];
    const double size = length(d);
    return size > 0.0 ? (1.0 / size) * d : d;
  }

  double cell_;
  int threads_;
  JoinedMeshes meshes_;
  SourceRegions found_;
  std::size_t count_;                 // of triangles
  std::vector<std::int32_t> firsts_;  // of each vertex, the first at its place; empty if not needed
  std::vector<Wall> walls_;
  std::vector<std::uint8_t> on_wall_;  // of each vertex
  std::vector<double> region_areas_;
  std::vector<float> vertex_areas_;
  int region_count_ = 0;
};
}  // namespace

JoinedMeshes::JoinedMeshes(std::span<const SourceMesh> sources) {
  for (const SourceMesh& source : sources) {
    check_mesh(source.mesh, kLargest);
    if (!source.groups.empty() && source.groups.size() != source.mesh.triangles.size()) {
      throw_invalid("sources: " + std::to_string(source.groups.size()) + " groups of " +
                    std::to_string(source.mesh.triangles.size()) +
                    " triangles; one each is needed");
    }
    meshes_.push_back(source.mesh);
    groups_.push_back(source.groups);
    first_vertices_.push_back(first_vertices_.back() + source.mesh.positions.size());
    first_triangles_.push_back(first_triangles_.back() + source.mesh.triangles.size());
  }
  constexpr std::size_t kMost = std::numeric_limits<std::int32_t>::max() / 3;
  if (vertex_count() > kMost || triangle_count() > kMost) {
    throw_invalid("sources: " + std::to_string(std::max(vertex_count(), triangle_count())) +
                  " vertices or triangles; at most " + std::to_string(kMost) + " are allowed");
  }
}

SourceRegions find_regions(std::span<const SourceMesh> sources, const RootFrame& frame, double cell,
                           const Progress& progress, int threads) {
  return RegionFinder(sources, frame, cell, threads).find(progress);
}

}  // namespace prefilter
