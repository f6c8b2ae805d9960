// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/voxels/remesh/simplify.h"

#include <cstddef>
#include <utility>
#include <vector>

#include "prefilter/base/error.h"
#include "prefilter/base/text.h"
#include "prefilter/voxels/remesh/facets.h"
#include "prefilter/voxels/remesh/patch.h"
#include "prefilter/voxels/remesh/simplify_facets.h"

namespace prefilter {
namespace {

void leave_out_unused(FacetedMesh* mesh) {
  std::vector<std::int32_t> places(mesh->positions.size(), -1);
  for (const auto& triangle : mesh->triangles) {
    for (const std::int32_t vertex : triangle) places[as_index(vertex)] = 0;
  }
  std::int32_t next = 0;
  for (std::size_t v = 0; v < places.size(); ++v) {
    if (places[v] < 0) continue;
    places[v] = next;
    mesh->positions[as_index(next)] = mesh->positions[v];
    if (!mesh->kinds.empty()) mesh->kinds[as_index(next)] = mesh->kinds[v];
    ++next;
  }
  mesh->positions.resize(as_index(next));
  if (!mesh->kinds.empty()) mesh->kinds.resize(as_index(next));
  for (auto& triangle : mesh->triangles) {
    for (std::int32_t& vertex : triangle) vertex = places[as_index(vertex)];
  }
}

}  // namespace

FacetedMesh simplify(FacetedMesh mesh, double tolerance, const Run& run) {
  if (!(tolerance >= 0.0 && tolerance <= kLargestCoordinate)) {
    throw_invalid("tolerance: found " + to_text(tolerance) + "; allowed are 0 and more");
  }
  if (tolerance > 0.0 && !mesh.triangles.empty()) {
    const SimplifyScale scale = scale_of(mesh.positions, mesh.triangles, tolerance);
    Facets facets;
    facets.triangles = std::move(mesh.triangles);
    facets.labels = std::move(mesh.labels);
    simplify_facets(mesh, scale, {}, run, &facets);
    mesh.triangles = std::move(facets.triangles);
    mesh.labels = std::move(facets.labels);
    leave_out_unused(&mesh);
  }
  run.report(1.0);
  return mesh;
}

}  // namespace prefilter
