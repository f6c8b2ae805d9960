// SPDX-License-Identifier: GPL-3.0-or-later

// The vertices of a contour: one for each pair of leaves that share a face and are on two sides.
#pragma once

#include <array>
#include <bit>
#include <compare>
#include <cstdint>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/voxels/contour/contour_tree.h"
#include "prefilter/voxels/contour/height_range.h"
#include "prefilter/voxels/contour/root_frame.h"
#include "prefilter/voxels/contour_options.h"

namespace prefilter {

/// What tells a vertex from all others of a tree: the leaf that its pair belongs to, and the face.
struct VertexPlace {
  CellCoordinates leaf;
  std::int8_t depth;
  std::int8_t face;

  auto operator<=>(const VertexPlace&) const = default;

  /// The heights that the face reaches, in cells of a tree's depth.
  int low(int tree_depth) const { return (leaf[2] + (face == 5 ? 1 : 0)) << (tree_depth - depth); }
  int high(int tree_depth) const { return (leaf[2] + (face == 4 ? 0 : 1)) << (tree_depth - depth); }
};

/// A pair belongs to the finer of its leaves; of two of the same size, to the one at the low side.
/// Its vertex lies on the line through that leaf's center across the face that they share, where
/// the other leaf, if it is coarser, has a cell of the same size. Positions are the frame's.
class SurfaceVertices {
 public:
  SurfaceVertices(const ContourTree& tree, const RootFrame& frame, Interpolant interpolant,
                  const Progress& progress, int threads);
  /// Those between leaves of which one reaches some heights at least, and their places.
  SurfaceVertices(const ContourTree& tree, const RootFrame& frame, Interpolant interpolant,
                  const HeightRange& heights);

  /// The vertex of the leaf that a pair belongs to, and its face.
  std::int32_t index(const CellNode& leaf, int face) const {
    const auto level = static_cast<std::size_t>(leaf.depth - 1);
    const int bit = 6 * leaf.octant + face;
    const std::uint64_t before = cuts_[level][leaf.block] & ((std::uint64_t{1} << bit) - 1);
    return static_cast<std::int32_t>(firsts_[level][leaf.block]) + std::popcount(before);
  }

  /// The vertex between two leaves on two sides of the surface; `high` is at the high side along
  /// the axis.
  std::int32_t between(const CellNode& low, const CellNode& high, int axis) const {
    return low.depth >= high.depth ? index(low, 2 * axis + 1) : index(high, 2 * axis);
  }

  const std::vector<Vector3>& positions() const { return positions_; }
  std::vector<Vector3> take_positions() { return std::move(positions_); }
  /// Of all vertices, where heights were given.
  const std::vector<VertexPlace>& places() const { return places_; }

  /// The faces with a vertex, of all octants of a block: bit 6 o + f.
  std::uint64_t cuts(std::size_t level, std::size_t block) const { return cuts_[level][block]; }
  std::uint32_t first(std::size_t level, std::size_t block) const { return firsts_[level][block]; }
  void move(std::size_t vertex, const Vector3& position) { positions_[vertex] = position; }

 private:
  void make(const ContourTree& tree, const RootFrame& frame, Interpolant interpolant,
            const HeightRange* heights, const Progress& progress, int threads);

  std::vector<std::vector<std::uint64_t>> cuts_;
  std::vector<std::vector<std::uint32_t>> firsts_;  // the vertex of a block's lowest bit
  std::vector<Vector3> positions_;
  std::vector<VertexPlace> places_;
};

}  // namespace prefilter
