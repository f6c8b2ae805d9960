// SPDX-License-Identifier: GPL-3.0-or-later

// Vertices of facets removed, pass by pass.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "prefilter/base/progress.h"
#include "prefilter/voxels/remesh/faceted_mesh.h"
#include "prefilter/voxels/remesh/facets.h"

namespace prefilter {

struct SimplifyScale {
  double tolerance;  // of what is measured; the rest is for what lies between
  double spacing;    // of vertices, in tolerances
};

/// For triangles of which there are some, of which none has been simplified.
SimplifyScale scale_of(std::span<const Vector3> positions,
                       std::span<const std::array<std::int32_t, 3>> triangles, double tolerance);

/// Vertices that stay; a flag for each, or none.
struct FixedVertices {
  std::vector<std::uint8_t> is_open = {};  // the triangles around are no closed ring, or not yet
  std::vector<std::uint8_t> is_kept = {};
};

/// `simplify` for facets of the positions of a mesh, of the same kinds. They may have been
/// simplified before: what is known of that counts.
void simplify_facets(const FacetedMesh& mesh, const SimplifyScale& scale, FixedVertices fixed,
                     const Progress& progress, int threads, Facets* facets);

}  // namespace prefilter
