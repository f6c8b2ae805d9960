// SPDX-License-Identifier: GPL-3.0-or-later

// A tree of cell means for contouring: leaves inside and outside, and their neighbors.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <vector>

#include "prefilter/base/run.h"
#include "prefilter/voxels/contour/edge_crossing.h"
#include "prefilter/wavelet/cell_tree.h"

namespace prefilter {

/// A cell of a tree, or one of the root-sized empty cells around the root.
struct CellNode {
  std::uint32_t block = 0;    // block that contains it, on level depth - 1
  std::uint32_t octants = 0;  // block of its octants, on level depth, if it is split
  std::int8_t depth = 0;      // 0: the root; -1: surroundings of the root
  std::uint8_t octant = 0;
  bool is_split = false;
  std::uint8_t sides = 0;  // bits kInside and kOutside: the sides on which its leaves lie

  bool is_outside() const { return depth < 0; }
};

inline constexpr std::uint8_t kInside = 1;
inline constexpr std::uint8_t kOutside = 2;
inline constexpr std::uint8_t kBothSides = kInside | kOutside;

inline constexpr CellNode kSurroundings = {0, 0, -1, 0, false, kOutside};

/// A tree with an iso-value. Leaves of at least that value are inside.
class ContourTree {
 public:
  /// Throws Error(kCancelled), as does update_sides.
  ContourTree(const CellTree& cells, float isovalue, const Run& run);

  const CellTree& cells() const { return cells_; }
  float isovalue() const { return isovalue_; }
  CellNode root() const { return {0, 0, 0, 0, !cells_.levels.empty(), root_sides_}; }

  /// Overrides the side of a leaf, kInside or kOutside. Requires update_sides() afterward.
  void set_side(std::size_t level, std::size_t block, int octant, std::uint8_t side) {
    std::uint16_t& sides = blocks_[level][block].sides;
    const int shift = 2 * octant;
    sides = static_cast<std::uint16_t>((sides & ~(kBothSides << shift)) | (side << shift));
  }
  void update_sides(const Run& run);

  /// The octant of a split cell; a leaf is its own octants.
  CellNode octant(const CellNode& node, int o) const {
    if (!node.is_split) return node;
    const Block& block = blocks_[static_cast<std::size_t>(node.depth)][node.octants];
    CellNode result;
    result.block = node.octants;
    result.depth = static_cast<std::int8_t>(node.depth + 1);
    result.octant = static_cast<std::uint8_t>(o);
    result.sides = static_cast<std::uint8_t>((block.sides >> (2 * o)) & kBothSides);
    result.is_split = ((block.split >> o) & 1U) != 0U;
    if (result.is_split) {
      const unsigned before = block.split & ((1U << o) - 1U);
      result.octants = block.first + static_cast<std::uint32_t>(std::popcount(before));
    }
    return result;
  }

  float value(const CellNode& node) const {
    if (node.depth > 0) {
      return cells_.levels[static_cast<std::size_t>(node.depth - 1)]
          .blocks[node.block][node.octant];
    }
    return node.is_outside() ? empty_sample(isovalue_) : cells_.root;
  }

 private:
  // The data of a block that traversals read, stored together.
  struct Block {
    std::uint32_t first;
    std::uint16_t sides;  // two bits per octant
    std::uint8_t split;
  };

  const CellTree& cells_;
  float isovalue_;
  std::vector<std::vector<Block>> blocks_;
  std::uint8_t root_sides_ = kOutside;
};

/// A tree of one cell, split once.
CellTree split_root(float value);

/// Coordinates of a cell at its depth.
using CellCoordinates = std::array<std::int32_t, 3>;

/// Coordinates of an octant of a cell, at the octant's depth.
inline CellCoordinates octant_at(const CellCoordinates& at, int o) {
  return {2 * at[0] + (o & 1), 2 * at[1] + ((o >> 1) & 1), 2 * at[2] + ((o >> 2) & 1)};
}

/// The cell of the same depth across each face, or the larger leaf that contains it. Faces are
/// numbered 2 a for the low side along axis a, and 2 a + 1 for the high side.
using FaceNeighbors = std::array<CellNode, 6>;

/// The neighbors of an octant, from the neighbors of its cell.
inline FaceNeighbors octant_neighbors(const ContourTree& tree, const CellNode& cell,
                                      const FaceNeighbors& of_cell, int octant) {
  FaceNeighbors result;
  for (int face = 0; face < 6; ++face) {
    const int bit = 1 << (face / 2);
    const bool towards_high = (face & 1) != 0;
    const bool is_high = (octant & bit) != 0;
    const CellNode& parent = towards_high == is_high ? of_cell[face] : cell;
    result[face] = tree.octant(parent, octant ^ bit);
  }
  return result;
}

}  // namespace prefilter
