// SPDX-License-Identifier: GPL-3.0-or-later

// The dual of a contour: its loops become the vertices of quads, and its vertices the quads.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "prefilter/base/run.h"
#include "prefilter/voxels/contour/contour_tree.h"
#include "prefilter/voxels/contour/surface_vertices.h"

namespace prefilter {

/// Loops of vertices, counterclockwise seen from outside, and the loops around each vertex.
struct DualLoops {
  std::vector<std::uint32_t> begins;  // of each loop, and the end of the last
  std::vector<std::int32_t> corners;
  // For each loop, the edge of its dual cell on which its first corner lies, and whether that cell
  // has other loops.
  std::vector<std::uint8_t> first_edges;
  std::vector<std::uint8_t> shares_cell;
  // The loops around each vertex, counterclockwise seen from outside.
  std::vector<std::array<std::int32_t, 4>> quads;

  std::size_t size() const { return begins.size() - 1; }
  std::span<const std::int32_t> loop(std::size_t i) const {
    return std::span(corners).subspan(begins[i], begins[i + 1] - begins[i]);
  }
};

/// Whether the surface passes only between leaves of the finest depth, or next to such leaves.
bool has_finest_vertices(const CellTree& cells, const SurfaceVertices& vertices);

/// The loops of a tree for which has_finest_vertices holds, by marching cubes on the dual grid.
///
/// The quads form a closed two-manifold: each loop has other loops on all its sides. Two loops
/// would share two sides across a face whose corners alternate between inside and outside; there
/// the inside corners are joined instead of the outside ones (R. Wenger, Isosurfaces, 2013), which
/// divides both loops. Throws Error(kCancelled), and Error(kOutOfMemory) for more than 2^31 loops.
DualLoops dual_loops(const ContourTree& tree, const SurfaceVertices& vertices, const Run& run);

}  // namespace prefilter
