// SPDX-License-Identifier: GPL-3.0-or-later

// Converts sharp loops to triangles.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "prefilter/voxels/contour/feature_places.h"
#include "prefilter/voxels/contour/linked_loops.h"
#include "prefilter/voxels/contour/sharp_vertices.h"
#include "prefilter/voxels/remesh/faceted_mesh.h"

namespace prefilter {

/// Mesh elements of sharp loops, stored after all others.
struct LoopTriangles {
  std::vector<std::int32_t> places;                 // per loop: its vertex; -1: none
  std::vector<std::array<std::int32_t, 2>> owners;  // per triangle: its loops; -1: only one
};

/// The label of the region on which a triangle of the contour lies; -1 far from edges.
std::int32_t label_of(const VertexSamples& samples, const std::array<std::int32_t, 3>& triangle);

/// Adds a vertex for each loop that is its own representative in `merged`, and the loops'
/// triangles: a fan around the vertex, with sides flipped where loops are joined. Where the fan
/// folds on one side of the edge, it is replaced there by the triangles that fit the region best.
/// Loops that are not sharp get their triangles from `plain`, the array in LoopedMesh.
LoopTriangles add_loops(const LinkedLoops& loops,
                        std::span<const std::array<std::int32_t, 3>> plain,
                        std::span<const Feature> features, std::span<const std::uint8_t> is_sharp,
                        std::span<const std::size_t> merged, const VertexSamples& samples,
                        FacetedMesh* mesh);

}  // namespace prefilter
