// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/voxels/quad_contour.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "prefilter/base/error.h"
#include "prefilter/base/text.h"
#include "prefilter/voxels/contour/dual_loops.h"
#include "prefilter/voxels/contour/dual_places.h"
#include "prefilter/voxels/contour/edge_source.h"
#include "prefilter/voxels/contour/fit_vertices.h"
#include "prefilter/voxels/contour/quad_surface.h"
#include "prefilter/voxels/contour/settle_quads.h"
#include "prefilter/voxels/contour/straight_borders.h"
#include "prefilter/voxels/contour/thickened_cells.h"
#include "prefilter/voxels/contour/unfold.h"
#include "prefilter/wavelet/fine_border.h"
#include "prefilter/wavelet/refine.h"

namespace prefilter {
namespace {

// A source triangle for each quad; -1 in thickened cells.
std::vector<std::int64_t> origins_of(const QuadSurface& surface, const SourceSurface& meshes,
                                     const ThickenedCells& thickened) {
  FacetedMesh mesh;
  mesh.positions = surface.positions;
  mesh.triangles = surface.triangles();
  for (const std::int32_t label : surface.labels) mesh.labels.insert(mesh.labels.end(), 2, label);
  const std::vector<std::int64_t> triangles = trace_labels(meshes, &mesh);
  std::vector<std::int64_t> origins;
  origins.reserve(surface.quads.size());
  for (std::size_t q = 0; q < surface.quads.size(); ++q) {
    Vector3 middle{};
    for (const std::int32_t v : surface.quads[q]) {
      middle = middle + 0.25 * surface.positions[static_cast<std::size_t>(v)];
    }
    origins.push_back(
        thickened.holds(middle) ? -1 : triangles[static_cast<std::size_t>(mesh.labels[2 * q])]);
  }
  return origins;
}

// Assigns leaves above the finest depth to the side of their value. In a refined tree such leaves
// on different sides are never adjacent.
void unsettle_coarse(const Run& run, ContourTree* tree) {
  const std::vector<TreeLevel>& levels = tree->cells().levels;
  for (std::size_t level = 0; level + 1 < levels.size(); ++level) {
    for (std::size_t block = 0; block < levels[level].size(); ++block) {
      for (int o = 0; o < 8; ++o) {
        if (levels[level].is_split(block, o)) continue;
        const float value = levels[level].blocks[block][static_cast<std::size_t>(o)];
        tree->set_side(level, block, o, value >= tree->isovalue() ? kInside : kOutside);
      }
    }
  }
  tree->update_sides(run);
}

// None if the surface passes between leaves that are not of the finest depth.
std::optional<QuadMesh> quads_of(const CellTree& cells, const Box& root, bool is_refined,
                                 const ContourOptions& options, const Run& run) {
  const RootFrame frame(root);
  const Interpolant interpolant = interpolant_of(options);
  const bool is_sharp = interpolant == Interpolant::kSharp;
  const bool fits = is_sharp || interpolant == Interpolant::kPlane;
  const Stages stages(run, {2, 2, 2, 1, 2, 1, 2, 2, 2, 3, 1});
  ContourTree tree(cells, options.isovalue, stages[0]);
  if (fits) settle_sides(stages[1], &tree);
  EdgeSource edges;
  if (is_sharp && !options.sources.empty()) {
    read_sources(cells, frame, options, stages[2], &tree, &edges);
  }
  if (is_refined) unsettle_coarse(stages[3], &tree);
  SurfaceVertices vertices(tree, frame, interpolant, stages[4]);
  if (!has_finest_vertices(cells, vertices)) return std::nullopt;
  if (fits) fit_vertices(tree, frame, stages[5], &vertices);
  if (is_sharp) {
    sample_edges(tree, frame, options.thickened, stages[6], &vertices, &edges);
  }
  const std::vector<Vector3> halves = halfway(tree, frame, vertices);
  const DualLoops loops = dual_loops(tree, vertices, stages[7]);
  if (is_sharp) straighten_borders(loops, *edges.surface(), &edges.samples, &vertices);
  Vector3 cell;
  for (int a = 0; a < 3; ++a) cell[a] = frame.cell(a, cells.depth());
  std::optional<FeaturePlaces> features;
  if (edges.surface() != nullptr) features.emplace(*edges.surface());
  const FeaturePlaces* on_edges = features ? &*features : nullptr;
  const DualPlaces places =
      dual_places(loops, vertices.positions(), halves, edges, on_edges, cell, stages[8]);
  QuadSurface surface = settled_quads(loops, places, edges, on_edges, cell, stages[9]);
  QuadMesh mesh;
  if (edges.meshes) {
    mesh.origins = origins_of(surface, *edges.meshes, {options.thickened, frame});
  }
  frame.place(stages[10], &surface.positions);
  mesh.positions = std::move(surface.positions);
  mesh.quads = std::move(surface.quads);
  run.report(1.0);
  return mesh;
}
}  // namespace

QuadMesh contour_quads(const CellTree& cells, const Box& root, const ContourOptions& options) {
  constexpr double kRefining = 0.3;
  check_box(root, "bounds");
  if (options.isovalue != 0.5F) {
    throw_invalid("isovalue: " + to_text(static_cast<double>(options.isovalue)) +
                  "; quads need 0.5");
  }
  if (cells.levels.empty())
    return *quads_of(split_root(cells.root), root, true, options, options.run);
  if (!has_coarse_surface(cells)) {
    std::optional<QuadMesh> mesh = quads_of(cells, root, false, options, options.run);
    if (mesh) return std::move(*mesh);
  }
  const CellTree fine =
      with_fine_border(refined(cells, cells.depth(), options.run.part(0.0, kRefining - 0.05)),
                       options.run.part(kRefining - 0.05, kRefining));
  std::optional<QuadMesh> mesh =
      quads_of(fine, root, true, options, options.run.part(kRefining, 1.0));
  if (!mesh) throw_invalid("octree: found a surface between cells of several sizes");
  return std::move(*mesh);
}

}  // namespace prefilter
