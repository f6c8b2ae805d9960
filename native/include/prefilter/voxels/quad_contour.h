// SPDX-License-Identifier: GPL-3.0-or-later

// Contours occupancy octrees as closed meshes of quads.
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
  // For each quad a source triangle, numbered across all sources, of the same source, group and
  // smooth region; -1 where the surface differs from the sources'. Empty without sources, or for
  // interpolants other than kSharp.
  std::vector<std::int64_t> origins;
};

/// Contours occupancies with quads only, by dual contouring (T. Ju et al., Dual contouring of
/// Hermite data, 2002) on the uniform cells along the surface: one vertex per part of the surface
/// in a cell of the dual grid, one quad per edge between an inside and an outside sample. The
/// description of contour_occupancies applies, except that there is neither clean-up nor
/// adaptivity; with kSharp, vertices lie on the edges and corners of the sources.
///
/// Also throws Error for iso-values other than 1/2.
QuadMesh contour_quads(const CellTree& cells, const Box& root, const ContourOptions& options);

}  // namespace prefilter
