#include "prefilter/solid/close_holes.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "prefilter/base/sort.h"

namespace prefilter {
namespace {

// A run from one vertex to another.
struct Run {
  std::uint32_t from;
  std::uint32_t to;

  bool operator<(const Run& other) const {
    return from != other.from ? from < other.from : to < other.to;
  }
};

// For each vertex, the first of those at its place.
std::vector<std::uint32_t> weld(const PositionView& positions, const Progress& progress,
                                int threads) {
  std::vector<std::uint32_t> order(positions.size());
  std::iota(order.begin(), order.end(), 0U);
  sort_in_parallel(&order, progress, threads, [&](std::uint32_t a, std::uint32_t b) {
    return positions[a] != positions[b] ? positions[a] < positions[b] : a < b;
  });
  std::vector<std::uint32_t> welded(positions.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    const bool is_same = i > 0 && positions[order[i]] == positions[order[i - 1]];
    welded[order[i]] = is_same ? welded[order[i - 1]] : order[i];
  }
  return welded;
}

// The runs that the mesh lacks: for each edge as many as there are more in the other direction.
std::vector<Run> missing_runs(const InputMesh& mesh, const std::vector<std::uint32_t>& welded,
                              const Progress& progress, int threads, std::size_t* open_edges) {
  // Edge and direction in one number: the direction in the lowest bit.
  std::vector<std::uint64_t> edges;
  edges.reserve(3 * mesh.triangles.size());
  for (const auto& triangle : mesh.triangles) {
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint64_t from = welded[static_cast<std::size_t>(triangle[i])];
      const std::uint64_t to = welded[static_cast<std::size_t>(triangle[(i + 1) % 3])];
      if (from == to) continue;
      edges.push_back((std::min(from, to) << 33U) | (std::max(from, to) << 1U) |
                      (from < to ? 0U : 1U));
    }
  }
  sort_in_parallel(&edges, progress.part(0.0, 0.7), threads);
  std::vector<Run> runs;
  *open_edges = 0;
  for (std::size_t i = 0; i < edges.size();) {
    const std::uint64_t edge = edges[i] >> 1U;
    std::ptrdiff_t excess = 0;
    for (; i < edges.size() && edges[i] >> 1U == edge; ++i) {
      excess += (edges[i] & 1U) == 0U ? 1 : -1;
    }
    const auto low = static_cast<std::uint32_t>(edge >> 32U);
    const auto high = static_cast<std::uint32_t>(edge & 0xFFFFFFFFU);
    if (excess != 0) ++*open_edges;
    for (; excess > 0; --excess) runs.push_back({high, low});
    for (; excess < 0; ++excess) runs.push_back({low, high});
  }
  sort_in_parallel(&runs, progress.part(0.7, 1.0), threads);
  return runs;
}

void add_fan(const PositionView& positions, std::span<const std::uint32_t> loop, Caps* caps) {
  ++caps->holes;
  if (loop.size() == 3) {
    caps->triangles.push_back({loop[0], loop[1], loop[2]});
    return;
  }
  // The middle of the line, not of its vertices, which may crowd together.
  Vector3 middle{};
  double around = 0.0;
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const Vector3& a = positions[loop[i]];
    const Vector3& b = positions[loop[(i + 1) % loop.size()]];
    const double weight = length(b - a);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      middle[axis] += weight * (a[axis] / 2.0 + b[axis] / 2.0);
    }
    around += weight;
  }
  for (double& x : middle) x /= around;
  const auto centre = static_cast<std::int64_t>(positions.size() + caps->positions.size());
  caps->positions.push_back(middle);
  for (std::size_t i = 0; i < loop.size(); ++i) {
    caps->triangles.push_back({centre, loop[i], loop[(i + 1) % loop.size()]});
  }
}

// Walks along the runs, each once. As many lead to a vertex as away from it, so a walk ends where
// it began; where it comes to a vertex again, it has closed a loop.
void add_fans(const PositionView& positions, const std::vector<Run>& runs, const Progress& progress,
              Caps* caps) {
  constexpr std::size_t kNowhere = static_cast<std::size_t>(-1);
  std::vector<std::size_t> next(positions.size(), kNowhere);  // the first run not yet walked
  for (std::size_t i = runs.size(); i-- > 0;) next[runs[i].from] = i;
  const auto take = [&](std::uint32_t vertex) {
    const std::size_t run = next[vertex];
    const bool has_more = run + 1 < runs.size() && runs[run + 1].from == vertex;
    next[vertex] = has_more ? run + 1 : kNowhere;
    return runs[run].to;
  };
  std::vector<std::size_t> places(positions.size(), kNowhere);  // in the walk
  std::vector<std::uint32_t> walk;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    if (i % 4096 == 0) progress.report(static_cast<double>(i) / static_cast<double>(runs.size()));
    if (next[runs[i].from] == kNowhere) continue;
    walk.push_back(runs[i].from);
    places[runs[i].from] = 0;
    while (!walk.empty() && next[walk.back()] != kNowhere) {
      const std::uint32_t vertex = take(walk.back());
      if (places[vertex] == kNowhere) {
        places[vertex] = walk.size();
        walk.push_back(vertex);
        continue;
      }
      const std::size_t begin = places[vertex];
      add_fan(positions, std::span(walk).subspan(begin), caps);
      for (std::size_t k = begin + 1; k < walk.size(); ++k) places[walk[k]] = kNowhere;
      walk.resize(begin + 1);
    }
    for (const std::uint32_t vertex : walk) places[vertex] = kNowhere;
    walk.clear();
  }
}
}  // namespace

Caps close_holes(const InputMesh& mesh, const Progress& progress, int threads) {
  check_mesh(mesh, kLargestCoordinate);
  Caps caps;
  const std::vector<std::uint32_t> welded = weld(mesh.positions, progress.part(0.0, 0.4), threads);
  const std::vector<Run> runs =
      missing_runs(mesh, welded, progress.part(0.4, 0.8), threads, &caps.open_edges);
  add_fans(mesh.positions, runs, progress.part(0.8, 1.0), &caps);
  progress.report(1.0);
  return caps;
}

}  // namespace prefilter
