// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/voxels/mesh_edges.h"

#include <limits>
#include <string>

#include "prefilter/base/error.h"
#include "prefilter/base/parallel.h"
#include "prefilter/voxels/solid/edge_table.h"

namespace prefilter {
namespace {

constexpr std::int64_t kVerticesPerTask = 1 << 13;

// Index of the corner at which a triangle's use of an edge begins.
std::size_t corner_of(const TriangleView& triangles, const EdgeUse& use, std::size_t low,
                      std::size_t high) {
  const auto corners = triangles[use.triangle];
  const auto from = static_cast<std::int64_t>(use.is_down ? high : low);
  const auto to = static_cast<std::int64_t>(use.is_down ? low : high);
  std::size_t i = 0;
  while (i < 2 && (corners[i] != from || corners[(i + 1) % 3] != to)) ++i;
  return 3 * std::size_t{use.triangle} + i;
}

// For each vertex the number of its first edge to a higher vertex; the last entry is the total.
std::vector<std::int32_t> first_edges(const EdgeTable& table, const Run& run) {
  const auto count = static_cast<std::int64_t>(table.vertex_count());
  std::vector<std::int32_t> first(table.vertex_count() + 1);
  parallel_ranges(count, kVerticesPerTask, run, [&](std::int64_t begin, std::int64_t end) {
    for (auto v = static_cast<std::size_t>(begin); v < static_cast<std::size_t>(end); ++v) {
      std::int32_t edges = 0;
      table.for_edges_from(v, [&](std::size_t, const auto&) { ++edges; });
      first[v + 1] = edges;
    }
  });
  for (std::size_t v = 1; v < first.size(); ++v) first[v] += first[v - 1];
  return first;
}

}  // namespace

MeshEdges find_mesh_edges(const InputMesh& mesh, const Run& run) {
  check_mesh(mesh, kLargestCoordinate);
  const std::size_t corners = 3 * mesh.triangles.size();
  if (corners > std::numeric_limits<std::int32_t>::max()) {
    throw_invalid("triangles: found " + std::to_string(mesh.triangles.size()) +
                  "; at most 715827882 have edges with numbers of 32 bits");
  }
  const Stages stages(run, {6, 1, 3});
  const EdgeTable table(mesh, stages[0]);
  const std::vector<std::int32_t> first = first_edges(table, stages[1]);
  MeshEdges edges;
  edges.vertices.resize(static_cast<std::size_t>(first.back()));
  edges.of_corners.assign(corners, -1);
  const auto number = [&](std::int64_t begin, std::int64_t end) {
    for (auto low = static_cast<std::size_t>(begin); low < static_cast<std::size_t>(end); ++low) {
      std::int32_t edge = first[low];
      table.for_edges_from(low, [&](std::size_t high, const auto& uses) {
        edges.vertices[static_cast<std::size_t>(edge)] = {static_cast<std::int32_t>(low),
                                                          static_cast<std::int32_t>(high)};
        for (const std::uint64_t use : uses) {
          edges.of_corners[corner_of(mesh.triangles, EdgeTable::use(use), low, high)] = edge;
        }
        ++edge;
      });
    }
  };
  parallel_ranges(static_cast<std::int64_t>(table.vertex_count()), kVerticesPerTask, stages[2],
                  number);
  return edges;
}

}  // namespace prefilter
