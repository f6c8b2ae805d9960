// SPDX-License-Identifier: GPL-3.0-or-later

// Vertices of a contour on the surface that its shape was made of.
#pragma once

#include <cstdint>
#include <vector>

#include "prefilter/base/progress.h"
#include "prefilter/voxels/contour/part_sides.h"
#include "prefilter/voxels/contour/source_surface.h"
#include "prefilter/voxels/contour/surface_vertices.h"
#include "prefilter/voxels/contour/thickened_cells.h"

namespace prefilter {

/// What vertices near edges know of the surface that they are on.
struct VertexSamples {
  std::vector<std::int32_t> index;  // of each vertex, its sample; -1: none
  std::vector<SourcePoint> samples;
  // For each sample that is off the line between its leaves, the nearest point of that; otherwise
  // its own position.
  std::vector<Vector3> on_lines;
  // For each sample, how much its normal points from the leaf inside to the one outside, -1 to 1; 0
  // off the line.
  std::vector<float> facing;
  std::vector<std::int32_t> tips;  // vertices where a smooth region comes to a point

  const SourcePoint* of(std::int32_t vertex) const {
    const std::int32_t i = index[static_cast<std::size_t>(vertex)];
    return i < 0 ? nullptr : &samples[static_cast<std::size_t>(i)];
  }
};

/// Moves the vertices near edges to where the lines that they are on cross the surface; where these
/// do not, to the nearest point. The vertex next to where a smooth region comes to a point goes
/// there. `parts` is for what was combined of several. Throws
/// Error(kCancelled).
VertexSamples sample_vertices(const ContourTree& tree, const RootFrame& frame,
                              const SourceSurface& surface, const PartSides* parts,
                              const ThickenedCells& thickened, const Progress& progress,
                              int threads, SurfaceVertices* vertices);

}  // namespace prefilter
