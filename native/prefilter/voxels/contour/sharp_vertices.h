// SPDX-License-Identifier: GPL-3.0-or-later

// Moves vertices of a contour onto the surface of the shape's sources.
#pragma once

#include <cstdint>
#include <vector>

#include "prefilter/base/run.h"
#include "prefilter/voxels/contour/part_sides.h"
#include "prefilter/voxels/contour/source_surface.h"
#include "prefilter/voxels/contour/surface_vertices.h"
#include "prefilter/voxels/contour/thickened_cells.h"

namespace prefilter {

/// Samples of the source surface at vertices near edges.
struct VertexSamples {
  std::vector<std::int32_t> index;  // per vertex: its sample; -1: none
  std::vector<SourcePoint> samples;
  // For each sample that is off the line between its leaves, the nearest point on that line;
  // otherwise its own position.
  std::vector<Vector3> on_lines;
  // For each sample, the component of its normal along the direction from the inner to the outer
  // leaf, from -1 to 1; 0 off the line.
  std::vector<float> facing;
  std::vector<std::int32_t> tips;  // vertices at the tips of smooth regions

  const SourcePoint* of(std::int32_t vertex) const {
    const std::int32_t i = index[static_cast<std::size_t>(vertex)];
    return i < 0 ? nullptr : &samples[static_cast<std::size_t>(i)];
  }
};

/// Moves the vertices near edges to where their lines cross the surface, or to the nearest point if
/// they do not. The vertex nearest to the tip of a smooth region moves there. `parts` is for shapes
/// combined from several parts. Throws Error(kCancelled).
VertexSamples sample_vertices(const ContourTree& tree, const RootFrame& frame,
                              const SourceSurface& surface, const PartSides* parts,
                              const ThickenedCells& thickened, const Run& run,
                              SurfaceVertices* vertices);

}  // namespace prefilter
