// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/voxels/solid/border_loops.h"

#include <algorithm>
#include <numeric>

#include "prefilter/base/sort.h"

namespace prefilter {
namespace {

constexpr std::size_t kNowhere = static_cast<std::size_t>(-1);
constexpr std::size_t kBorderLoopsRowsPerReport = 1U << 18U;

// A directed edge.
struct HalfEdge {
  std::uint32_t from;
  std::uint32_t to;

  bool operator<(const HalfEdge& other) const {
    return from != other.from ? from < other.from : to < other.to;
  }
  bool operator==(const HalfEdge& other) const { return from == other.from && to == other.to; }
};

// For each vertex, the first one with the same position.
std::vector<std::uint32_t> weld_equal_positions(const PositionView& positions, const Run& run) {
  std::vector<std::uint32_t> order(positions.size());
  std::iota(order.begin(), order.end(), 0U);
  sort_in_parallel(&order, run, [&](std::uint32_t a, std::uint32_t b) {
    return positions[a] != positions[b] ? positions[a] < positions[b] : a < b;
  });
  std::vector<std::uint32_t> welded(positions.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    const bool is_same = i > 0 && positions[order[i]] == positions[order[i - 1]];
    welded[order[i]] = is_same ? welded[order[i - 1]] : order[i];
  }
  return welded;
}

// The half-edges that the mesh lacks: for each edge, the difference between its two directions.
std::vector<HalfEdge> missing_half_edges(const InputMesh& mesh,
                                         const std::vector<std::uint32_t>& welded, const Run& run,
                                         std::size_t* open_edges) {
  // Edge and direction in one integer: the direction is in the lowest bit.
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
  const Stages stages(run, {7, 3});
  sort_in_parallel(&edges, stages[0]);
  std::vector<HalfEdge> half_edges;
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
    for (; excess > 0; --excess) half_edges.push_back({high, low});
    for (; excess < 0; ++excess) half_edges.push_back({low, high});
  }
  sort_in_parallel(&half_edges, stages[1]);
  return half_edges;
}

// For each vertex the index of its first outgoing half-edge.
std::vector<std::size_t> first_half_edges(std::size_t vertices,
                                          const std::vector<HalfEdge>& half_edges) {
  std::vector<std::size_t> first(vertices, kNowhere);
  for (std::size_t i = half_edges.size(); i-- > 0;) first[half_edges[i].from] = i;
  return first;
}

// The face across each half-edge; kNone where there are several.
std::vector<std::uint32_t> faces_of(const InputMesh& mesh, const std::vector<std::uint32_t>& welded,
                                    const std::vector<HalfEdge>& half_edges,
                                    const std::vector<std::size_t>& first, const Run& run) {
  std::vector<std::uint32_t> faces(half_edges.size(), BorderLoops::kNone);
  std::vector<unsigned char> has_face(half_edges.size(), 0);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (t % kBorderLoopsRowsPerReport == 0) {
      run.report(static_cast<double>(t) / static_cast<double>(mesh.triangles.size()));
    }
    const auto& triangle = mesh.triangles[t];
    for (std::size_t i = 0; i < 3; ++i) {
      // A half-edge runs opposite to its face's edge.
      const HalfEdge half_edge{welded[static_cast<std::size_t>(triangle[(i + 1) % 3])],
                               welded[static_cast<std::size_t>(triangle[i])]};
      if (first[half_edge.from] == kNowhere) continue;
      const auto it = std::lower_bound(half_edges.begin(), half_edges.end(), half_edge);
      if (it == half_edges.end() || !(*it == half_edge)) continue;
      const auto r = static_cast<std::size_t>(it - half_edges.begin());
      faces[r] = has_face[r] != 0 ? BorderLoops::kNone : static_cast<std::uint32_t>(t);
      has_face[r] = 1;
    }
  }
  for (std::size_t r = 1; r < half_edges.size(); ++r) {
    if (half_edges[r] == half_edges[r - 1]) faces[r] = faces[r - 1] = BorderLoops::kNone;
  }
  return faces;
}

// Component of each vertex, named by its lowest vertex: components are connected by triangles.
std::vector<std::uint32_t> parts_of(const InputMesh& mesh, const std::vector<std::uint32_t>& welded,
                                    const Run& run) {
  std::vector<std::uint32_t> parts = welded;
  const auto part_of = [&](std::uint32_t vertex) {
    while (parts[vertex] != vertex) vertex = parts[vertex] = parts[parts[vertex]];
    return vertex;
  };
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (t % kBorderLoopsRowsPerReport == 0) {
      run.report(static_cast<double>(t) / static_cast<double>(mesh.triangles.size()));
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

// Walks along each half-edge once. Every vertex has as many incoming as outgoing ones, so a walk
// ends where it began; when it reaches a vertex again, it has closed a loop.
void walk_along(const std::vector<HalfEdge>& half_edges, const std::vector<std::uint32_t>& faces,
                std::vector<std::size_t> next, const Run& run, BorderLoops* loops) {
  std::vector<std::size_t> indices(next.size(), kNowhere);  // index in the walk
  std::vector<std::uint32_t> walk;
  std::vector<std::uint32_t> beside;
  for (std::size_t i = 0; i < half_edges.size(); ++i) {
    if (i % 4096 == 0) run.report(static_cast<double>(i) / static_cast<double>(half_edges.size()));
    if (next[half_edges[i].from] == kNowhere) continue;
    walk.push_back(half_edges[i].from);
    indices[half_edges[i].from] = 0;
    while (!walk.empty() && next[walk.back()] != kNowhere) {
      const std::size_t half_edge = next[walk.back()];
      const bool has_more =
          half_edge + 1 < half_edges.size() && half_edges[half_edge + 1].from == walk.back();
      next[walk.back()] = has_more ? half_edge + 1 : kNowhere;
      beside.push_back(faces[half_edge]);
      const std::uint32_t vertex = half_edges[half_edge].to;
      if (indices[vertex] == kNowhere) {
        indices[vertex] = walk.size();
        walk.push_back(vertex);
        continue;
      }
      const std::size_t begin = indices[vertex];
      const auto from = static_cast<std::ptrdiff_t>(begin);
      loops->vertices.insert(loops->vertices.end(), walk.begin() + from, walk.end());
      loops->faces.insert(loops->faces.end(), beside.begin() + from, beside.end());
      loops->begins.push_back(loops->vertices.size());
      for (std::size_t k = begin + 1; k < walk.size(); ++k) indices[walk[k]] = kNowhere;
      walk.resize(begin + 1);
      beside.resize(begin);
    }
    for (const std::uint32_t vertex : walk) indices[vertex] = kNowhere;
    walk.clear();
    beside.clear();
  }
}

}  // namespace

BorderLoops border_loops(const InputMesh& mesh, const Run& run) {
  BorderLoops loops;
  const Stages stages(run, {4, 3, 1, 1, 1});
  const std::vector<std::uint32_t> welded = weld_equal_positions(mesh.positions, stages[0]);
  const std::vector<HalfEdge> half_edges =
      missing_half_edges(mesh, welded, stages[1], &loops.open_edges);
  if (!half_edges.empty()) {
    std::vector<std::size_t> first = first_half_edges(mesh.positions.size(), half_edges);
    const std::vector<std::uint32_t> faces = faces_of(mesh, welded, half_edges, first, stages[2]);
    loops.parts = parts_of(mesh, welded, stages[3]);
    walk_along(half_edges, faces, std::move(first), stages[4], &loops);
  }
  run.report(1.0);
  return loops;
}

}  // namespace prefilter
