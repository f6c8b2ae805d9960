// SPDX-License-Identifier: GPL-3.0-or-later

// Sharp loops to triangles.
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

/// What a mesh has of sharp loops, behind everything else.
struct LoopTriangles {
  std::vector<std::int32_t> places;                 // of each loop its vertex; -1: none
  std::vector<std::array<std::int32_t, 2>> owners;  // of each triangle its loops; -1: just one
};

/// The label of the region that a triangle of the contour is on; -1 far from edges.
std::int32_t label_of(const VertexSamples& samples, const std::array<std::int32_t, 3>& triangle);

/// Adds a vertex for each loop of `merged` that is its own first one, and the loops' triangles: a
/// fan around the vertex, whose sides are flipped where loops are joined. Where the fan folds on
/// one side of the edge, what is there gets the triangles that lie best on its region. Loops that
/// are not sharp have triangles of `plain`, those of LoopedMesh.
LoopTriangles add_loops(const LinkedLoops& loops,
                        std::span<const std::array<std::int32_t, 3>> plain,
                        std::span<const Feature> features, std::span<const std::uint8_t> is_sharp,
                        std::span<const std::size_t> merged, const VertexSamples& samples,
                        FacetedMesh* mesh);

}  // namespace prefilter
