// SPDX-License-Identifier: GPL-3.0-or-later

// The vertices of a contour: one per pair of leaves on different sides that share a face.
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

/// Identifies a vertex in a tree: the leaf that owns it, and the face.
struct VertexPlace {
  CellCoordinates leaf;
  std::int8_t depth;
  std::int8_t face;

  auto operator<=>(const VertexPlace&) const = default;

  /// Range of heights of the face, in cells of a tree's depth.
  int low(int tree_depth) const { return (leaf[2] + (face == 5 ? 1 : 0)) << (tree_depth - depth); }
  int high(int tree_depth) const { return (leaf[2] + (face == 4 ? 0 : 1)) << (tree_depth - depth); }
};

/// A pair belongs to the finer of its leaves, or to the leaf at the low side if both have the same
/// size. Its vertex lies on the line through that leaf's center across the shared face; a coarser
/// second leaf is represented by a cell of the same size. Positions are in the frame.
class SurfaceVertices {
 public:
  SurfaceVertices(const ContourTree& tree, const RootFrame& frame, Interpolant interpolant,
                  const Run& run);
  /// Vertices of pairs with at least one leaf in a range of heights, and their places.
  SurfaceVertices(const ContourTree& tree, const RootFrame& frame, Interpolant interpolant,
                  const HeightRange& heights);

  /// The vertex of the leaf that owns a pair, and its face.
  std::int32_t index(const CellNode& leaf, int face) const {
    const auto level = static_cast<std::size_t>(leaf.depth - 1);
    const int bit = 6 * leaf.octant + face;
    const std::uint64_t before = cuts_[level][leaf.block] & ((std::uint64_t{1} << bit) - 1);
    return static_cast<std::int32_t>(firsts_[level][leaf.block]) + std::popcount(before);
  }

  /// The vertex between two leaves on different sides; `high` is at the high side along the axis.
  std::int32_t between(const CellNode& low, const CellNode& high, int axis) const {
    return low.depth >= high.depth ? index(low, 2 * axis + 1) : index(high, 2 * axis);
  }

  const std::vector<Vector3>& positions() const { return positions_; }
  std::vector<Vector3> take_positions() { return std::move(positions_); }
  /// Places of all vertices, if heights were given.
  const std::vector<VertexPlace>& places() const { return places_; }

  /// Faces with a vertex, of all octants of a block: bit 6 o + f.
  std::uint64_t cuts(std::size_t level, std::size_t block) const { return cuts_[level][block]; }
  std::uint32_t first(std::size_t level, std::size_t block) const { return firsts_[level][block]; }
  void move(std::size_t vertex, const Vector3& position) { positions_[vertex] = position; }

 private:
  void make(const ContourTree& tree, const RootFrame& frame, Interpolant interpolant,
            const HeightRange* heights, const Run& run);

  std::vector<std::vector<std::uint64_t>> cuts_;
  std::vector<std::vector<std::uint32_t>> firsts_;  // vertex of the lowest bit of each block
  std::vector<Vector3> positions_;
  std::vector<VertexPlace> places_;
};

}  // namespace prefilter
