// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/voxels/contour/edge_source.h"

#include "prefilter/voxels/contour/thickened_cells.h"
#include "prefilter/voxels/remesh/spread_labels.h"

namespace prefilter {

void read_sources(const CellTree& cells, const RootFrame& frame, const ContourOptions& options,
                  const Run& run, ContourTree* tree, EdgeSource* edges) {
  const Stages stages(run, {33, 10, 7});
  edges->meshes.emplace(options.sources, frame, frame.cell(0, cells.depth()), stages[0]);
  if (!edges->meshes->has_meetings()) return;
  edges->part_sides.emplace(*tree, frame, *edges->meshes, stages[1]);
  edges->part_sides->settle({options.thickened, frame}, stages[2], tree);
}

void sample_edges(const ContourTree& tree, const RootFrame& frame, const CellTree* thickened,
                  const Run& run, SurfaceVertices* vertices, EdgeSource* edges) {
  if (edges->meshes) {
    edges->samples = sample_vertices(tree, frame, *edges->meshes,
                                     edges->part_sides ? &*edges->part_sides : nullptr,
                                     {thickened, frame}, run, vertices);
    return;
  }
  const Stages stages(run, {1, 1});
  edges->smooth_parts.emplace(tree, frame, *vertices, stages[0]);
  edges->samples = edges->smooth_parts->sample_vertices(stages[1], vertices);
}

std::vector<std::int64_t> trace_labels(const SourceSurface& surface, FacetedMesh* mesh) {
  std::vector<std::int64_t> triangles = surface.first_triangles();
  const auto known = static_cast<std::int32_t>(triangles.size());
  const int added = spread_labels(mesh, known, Run());
  triangles.resize(triangles.size() + static_cast<std::size_t>(added), -1);
  // Regions without edges nearby: use any of their triangles.
  for (std::size_t t = 0; t < mesh->triangles.size() && added > 0; ++t) {
    std::int64_t& triangle = triangles[static_cast<std::size_t>(mesh->labels[t])];
    if (triangle >= 0) continue;
    const auto& [a, b, c] = mesh->triangles[t];
    triangle = surface.nearest_of_all((1.0 / 3.0) * (mesh->positions[static_cast<std::size_t>(a)] +
                                                     mesh->positions[static_cast<std::size_t>(b)] +
                                                     mesh->positions[static_cast<std::size_t>(c)]));
  }
  return triangles;
}

}  // namespace prefilter
