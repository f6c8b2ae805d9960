// SPDX-License-Identifier: GPL-3.0-or-later

// The source of a contour's edges.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "prefilter/base/run.h"
#include "prefilter/voxels/contour/contour_tree.h"
#include "prefilter/voxels/contour/looped_mesh.h"
#include "prefilter/voxels/contour/occupancy_surface.h"
#include "prefilter/voxels/contour/part_sides.h"
#include "prefilter/voxels/contour/root_frame.h"
#include "prefilter/voxels/contour/sharp_vertices.h"
#include "prefilter/voxels/contour/source_surface.h"
#include "prefilter/voxels/contour/surface_vertices.h"
#include "prefilter/voxels/contour_options.h"
#include "prefilter/voxels/remesh/faceted_mesh.h"

namespace prefilter {

/// The interpolant of a tree's contour, kSharp by default.
inline Interpolant interpolant_of(const ContourOptions& options) {
  return options.interpolant.value_or(Interpolant::kSharp);
}

/// A surface with edges, and samples of it at the vertices.
struct EdgeSource {
  std::optional<SourceSurface> meshes;
  std::optional<PartSides> part_sides;           // where several meshes meet
  std::optional<OccupancySurface> smooth_parts;  // used if there are no meshes
  VertexSamples samples;
  Crossings crossings;

  const FeatureSurface* surface() const {
    if (meshes) return &*meshes;
    return smooth_parts ? &*smooth_parts : nullptr;
  }
};

/// Reads the sources, which must exist, and sets the sides of leaves where several sources meet.
/// Throws as SourceSurface does.
void read_sources(const CellTree& cells, const RootFrame& frame, const ContourOptions& options,
                  const Run& run, ContourTree* tree, EdgeSource* edges);

/// Moves the vertices near edges onto the sources, or onto the surface that the occupancies define
/// if there are none. Throws Error(kCancelled).
void sample_edges(const ContourTree& tree, const RootFrame& frame, const CellTree* thickened,
                  const Run& run, SurfaceVertices* vertices, EdgeSource* edges);

/// Gives all triangles labels; returns a source triangle for each label.
std::vector<std::int64_t> trace_labels(const SourceSurface& surface, FacetedMesh* mesh);

}  // namespace prefilter
