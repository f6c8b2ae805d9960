// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/voxels/solid/border_loops.h"

#include <algorithm>
#include <numeric>

#include "prefilter/base/sort.h"

namespace prefilter {
namespace {

constexpr std::size_t kNowhere = static_cast<std::size_t>(-1);
constexpr std::size_t kRowsPerReport = 1U << 18U;

// A run from one vertex to another.
struct Run {
  std::uint32_t from;
  std::uint32_t to;

  bool operator<(const Run& other) const {
    return from != other.from ? from < other.from : to < other.to;
  }
  bool operator==(const Run& other) const { return from == other.from && to == other.to; }
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

// For each vertex the first of the runs that lead away from it.
std::vector<std::size_t> first_runs(std::size_t vertices, const std::vector<Run>& runs) {
  std::vector<std::size_t> first(vertices, kNowhere);
  for (std::size_t i = runs.size(); i-- > 0;) first[runs[i].from] = i;
  return first;
}

// The faces on the other side of the runs; kNone where there are several.
std::vector<std::uint32_t> faces_of(const InputMesh& mesh, const std::vector<std::uint32_t>& welded,
                                    const std::vector<Run>& runs,
                                    const std::vector<std::size_t>& first,
                                    const Progress& progress) {
  std::vector<std::uint32_t> faces(runs.size(), BorderLoops::kNone);
  std::vector<unsigned char> has_face(runs.size(), 0);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (t % kRowsPerReport == 0) {
      progress.report(static_cast<double>(t) / static_cast<double>(mesh.triangles.size()));
    }
    const auto& triangle = mesh.triangles[t];
    for (std::size_t i = 0; i < 3; ++i) {
      // The run goes the other way.
      const Run run{welded[static_cast<std::size_t>(triangle[(i + 1) % 3])],
                    welded[static_cast<std::size_t>(triangle[i])]};
      if (first[run.from] == kNowhere) continue;
      const auto found = std::lower_bound(runs.begin(), runs.end(), run);
      if (found == runs.end() || !(*found == run)) continue;
      const auto r = static_cast<std::size_t>(found - runs.begin());
      faces[r] = has_face[r] != 0 ? BorderLoops::kNone : static_cast<std::uint32_t>(t);
      has_face[r] = 1;
    }
  }
  for (std::size_t r = 1; r < runs.size(); ++r) {
    if (runs[r] == runs[r - 1]) faces[r] = faces[r - 1] = BorderLoops::kNone;
  }
  return faces;
}

// For each vertex one of those that triangles join it with, the same for all of these.
std::vector<std::uint32_t> parts_of(const InputMesh& mesh, const std::vector<std::uint32_t>& welded,
                                    const Progress& progress) {
  std::vector<std::uint32_t> parts = welded;
  const auto part_of = [&](std::uint32_t vertex) {
    while (parts[vertex] != vertex) vertex = parts[vertex] = parts[parts[vertex]];
    return vertex;
  };
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (t % kRowsPerReport == 0) {
      progress.report(static_cast<double>(t) / static_cast<double>(mesh.triangles.size()));
    }
    const auto& triangle = mesh.triangles[t];
    const std::uint32_t a = part_of(static_cast<std::uint32_t>(triangle[0]));
    const std::uint32_t b = part_of(static_cast<std::uint32_t>(triangle[1]));
    const std::uint32_t c = part_of(static_cast<std::uint32_t>(triangle[2]));
    const std::uint32_t least = std::min({a, b, c});
    parts[a] = parts[b] = parts[c] = least;
  }
  for (std::uint32_t v = 0; v < parts.size(); ++v) parts[v] = part_of(v);
  return parts;
}

// Walks along the runs, each once. As many lead to a vertex as away from it, so a walk ends where
// it began; where it comes to a vertex again, it has closed a loop.
void walk_along(const std::vector<Run>& runs, const std::vector<std::uint32_t>& faces,
                std::vector<std::size_t> next, const Progress& progress, BorderLoops* loops) {
  std::vector<std::size_t> places(next.size(), kNowhere);  // in the walk
  std::vector<std::uint32_t> walk;
  std::vector<std::uint32_t> beside;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    if (i % 4096 == 0) progress.report(static_cast<double>(i) / static_cast<double>(runs.size()));
    if (next[runs[i].from] == kNowhere) continue;
    walk.push_back(runs[i].from);
    places[runs[i].from] = 0;
    while (!walk.empty() && next[walk.back()] != kNowhere) {
      const std::size_t run = next[walk.back()];
      const bool has_more = run + 1 < runs.size() && runs[run + 1].from == walk.back();
      next[walk.back()] = has_more ? run + 1 : kNowhere;
      beside.push_back(faces[run]);
      const std::uint32_t vertex = runs[run].to;
      if (places[vertex] == kNowhere) {
        places[vertex] = walk.size();
        walk.push_back(vertex);
        continue;
      }
      const std::size_t begin = places[vertex];
      const auto from = static_cast<std::ptrdiff_t>(begin);
      loops->vertices.insert(loops->vertices.end(), walk.begin() + from, walk.end());
      loops->faces.insert(loops->faces.end(), beside.begin() + from, beside.end());
      loops->begins.push_back(loops->vertices.size());
      for (std::size_t k = begin + 1; k < walk.size(); ++k) places[walk[k]] = kNowhere;
      walk.resize(begin + 1);
      beside.resize(begin);
    }
    for (const std::uint32_t vertex : walk) places[vertex] = kNowhere;
    walk.clear();
    beside.clear();
  }
}

}  // namespace

BorderLoops border_loops(const InputMesh& mesh, const Progress& progress, int threads) {
  BorderLoops loops;
  const std::vector<std::uint32_t> welded = weld(mesh.positions, progress.part(0.0, 0.4), threads);
  const std::vector<Run> runs =
      missing_runs(mesh, welded, progress.part(0.4, 0.7), threads, &loops.open_edges);
  if (!runs.empty()) {
    std::vector<std::size_t> first = first_runs(mesh.positions.size(), runs);
    const std::vector<std::uint32_t> faces =
        faces_of(mesh, welded, runs, first, progress.part(0.7, 0.8));
    loops.parts = parts_of(mesh, welded, progress.part(0.8, 0.9));
    walk_along(runs, faces, std::move(first), progress.part(0.9, 1.0), &loops);
  }
  progress.report(1.0);
  return loops;
}

}  // namespace prefilter
