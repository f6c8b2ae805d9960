// The vertices of a contour: one for each pair of leaves that share a face and are on two sides.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/contour/contour_options.h"
#include "prefilter/contour/contour_tree.h"
#include "prefilter/contour/root_frame.h"

namespace prefilter {

/// A pair belongs to the finer of its leaves; of two of the same size, to the one at the low side.
/// Its vertex lies on the line through that leaf's centre across the face that they share, where
/// the other leaf, if it is coarser, has a cell of the same size. Positions are the frame's.
class SurfaceVertices {
 public:
  SurfaceVertices(const ContourTree& tree, const RootFrame& frame, Interpolant interpolant,
                  const Progress& progress, int threads);

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

  /// The faces with a vertex, of all octants of a block: bit 6 o + f.
  std::uint64_t cuts(std::size_t level, std::size_t block) const { return cuts_[level][block]; }
  std::uint32_t first(std::size_t level, std::size_t block) const { return firsts_[level][block]; }
  void move(std::size_t vertex, const Vector3& position) { positions_[vertex] = position; }

 private:
  std::vector<std::vector<std::uint64_t>> cuts_;
  std::vector<std::vector<std::uint32_t>> firsts_;  // the vertex of a block's lowest bit
  std::vector<Vector3> positions_;
};

}  // namespace prefilter
