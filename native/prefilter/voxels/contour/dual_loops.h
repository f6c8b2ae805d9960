// SPDX-License-Identifier: GPL-3.0-or-later

// The dual of a contour: its loops are the vertices of quads, and its vertices the quads.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "prefilter/base/progress.h"
#include "prefilter/voxels/contour/contour_tree.h"
#include "prefilter/voxels/contour/surface_vertices.h"

namespace prefilter {

/// Loops of vertices, counter-clockwise seen from outside, and the loops around each vertex.
struct DualLoops {
  std::vector<std::uint32_t> begins;  // of each loop, and the end of the last one
  std::vector<std::int32_t> corners;
  // Of each loop: on which edge of its dual cell its first corner is, and whether there are others
  // in that cell.
  std::vector<std::uint8_t> first_edges;
  std::vector<std::uint8_t> shares_cell;
  // Of each vertex: the loops around it, counter-clockwise seen from outside.
  std::vector<std::array<std::int32_t, 4>> quads;

  std::size_t size() const { return begins.size() - 1; }
  std::span<const std::int32_t> loop(std::size_t i) const {
    return std::span(corners).subspan(begins[i], begins[i + 1] - begins[i]);
  }
};

/// Whether all leaves that the surface passes between are of the finest depth, or beside such.
bool has_finest_vertices(const CellTree& cells, const SurfaceVertices& vertices);

/// The loops of a tree that has_finest_vertices: marching cubes on the dual grid.
///
/// Quads are a closed two-manifold: each loop lies between other ones on all its sides. Where two
/// loops would lie beside each other twice, across a face whose corners are inside and outside in
/// turns, the insides are joined there instead of the outsides (Wenger 2013), which cuts both in
/// two. Throws Error(kCancelled), and Error(kOutOfMemory) for more than 2^31 loops.
DualLoops dual_loops(const ContourTree& tree, const SurfaceVertices& vertices,
                     const Progress& progress, int threads);

}  // namespace prefilter
