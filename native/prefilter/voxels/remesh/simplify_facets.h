// SPDX-License-Identifier: GPL-3.0-or-later

// Removes vertices of facets, pass by pass.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "prefilter/base/run.h"
#include "prefilter/voxels/remesh/faceted_mesh.h"
#include "prefilter/voxels/remesh/facets.h"

namespace prefilter {

struct SimplifyScale {
  double tolerance;  // for measured points; the remainder is for the surface between them
  double spacing;    // of vertices, in tolerances
};

/// The scale for a nonempty set of triangles that has not been simplified yet.
SimplifyScale scale_of(std::span<const Vector3> positions,
                       std::span<const std::array<std::int32_t, 3>> triangles, double tolerance);

/// Flags of vertices that stay; empty: none.
struct FixedVertices {
  // the triangles around it form no closed ring, or are incomplete
  std::vector<std::uint8_t> is_open = {};
  std::vector<std::uint8_t> is_kept = {};
};

/// Simplifies facets over the positions and kinds of a mesh; see simplify.h. They may have been
/// simplified before, in which case their errors accumulate.
void simplify_facets(const FacetedMesh& mesh, const SimplifyScale& scale, FixedVertices fixed,
                     const Run& run, Facets* facets);

}  // namespace prefilter
