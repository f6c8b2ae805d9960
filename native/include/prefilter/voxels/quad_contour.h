// SPDX-License-Identifier: GPL-3.0-or-later

// Occupancy octrees to closed meshes of quads.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/voxels/contour_options.h"
#include "prefilter/wavelet/cell_tree.h"

namespace prefilter {

struct QuadMesh {
  std::vector<Vector3> positions;
  std::vector<std::array<std::int32_t, 4>> quads;
  // For each quad a triangle of the sources, numbered through all of them, that belongs to the same
  // source, group and smooth region; -1 where the surface is not that of the sources. Empty without
  // sources, or of another interpolant than kSharp.
  std::vector<std::int64_t> origins;
};

/// The contour of occupancies as quads alone, by dual contouring (Ju et al. 2002) on the uniform
/// cells along the surface: a vertex for each part of the surface in a cell of the dual grid, and a
/// quad for each edge between an inner and an outer sample. All that is said of contour_occupancies
/// holds, but that nothing is cleaned up and there is no adaptivity; with kSharp, vertices are on
/// the edges and corners of the sources.
///
/// Throws Error, too, for another iso-value than 1/2.
QuadMesh contour_quads(const CellTree& cells, const Box& root, const ContourOptions& options);

}  // namespace prefilter
