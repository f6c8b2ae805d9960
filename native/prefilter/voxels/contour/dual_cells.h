// SPDX-License-Identifier: GPL-3.0-or-later

// The dual grid of an octree's leaves: around every corner of a leaf there is a cell whose corners
// are the centers of the eight leaves, or fewer, that meet there (T. Ju, F. Losasso, S. Schaefer,
// J. Warren, Dual contouring of Hermite data, 2002; S. Schaefer, J. Warren, Dual marching cubes,
// 2004).
#pragma once

#include <array>
#include <vector>

#include "prefilter/voxels/contour/contour_tree.h"
#include "prefilter/voxels/contour/height_range.h"

namespace prefilter {

/// Eight cells that meet at a point: cell i lies at the high side along x if bit 0 of i is set,
/// along y for bit 1, along z for bit 2. Larger cells appear several times.
using Meeting = std::array<CellNode, 8>;

/// Finds the meeting points of leaves that the surface passes through, at given heights, in parts
/// that can be visited in any order.
class DualCells {
 public:
  explicit DualCells(const ContourTree& tree, const HeightRange& heights = HeightRange());

  std::size_t part_count() const { return parts_.size(); }

  /// Calls visit(meeting) for each meeting of a part; the eight cells are leaves, on both sides.
  template <typename Visit>
  void for_part(std::size_t part, const Visit& visit) const {
    const Part& p = parts_[part];
    switch (p.kind) {
      case Kind::kCell:
        in_cell(p.layer, p.cells[0], visit);
        break;
      case Kind::kFace:
        at_face(p.layer, p.axis, p.cells[0], p.cells[1], visit);
        break;
      case Kind::kEdge:
        at_edge(p.layer, p.axis, {p.cells[0], p.cells[1], p.cells[2], p.cells[3]}, visit);
        break;
      case Kind::kPoint:
        at_point(p.layer, p.cells, visit);
        break;
    }
  }

 private:
  enum class Kind { kCell, kFace, kEdge, kPoint };
  /// Height and size of the lowest of the cells that meet; larger leaves are cut to the others'
  /// size.
  struct Layer {
    int z;
    int height;

    Layer half(int upper) const { return {z + upper * (height / 2), height / 2}; }
  };
  struct Part {
    Kind kind;
    Layer layer;
    int axis;
    Meeting cells;
  };

  template <typename Visit>
  void in_cell(const Layer& layer, const CellNode& cell, const Visit& visit) const;
  template <typename Visit>
  void at_face(const Layer& layer, int axis, const CellNode& low, const CellNode& high,
               const Visit& visit) const;
  /// Cell k lies at the high side along axis + 1 if bit 0 of k is set, along axis + 2 for bit 1.
  template <typename Visit>
  void at_edge(const Layer& layer, int axis, const std::array<CellNode, 4>& around,
               const Visit& visit) const;
  template <typename Visit>
  void at_point(const Layer& layer, Meeting cells, const Visit& visit) const;

  /// Whether points within a layer, or between it and the next one, may be at the requested
  /// heights.
  bool is_wanted(const Layer& layer, bool is_between) const {
    const int top = layer.z + layer.height;
    return is_between ? heights_.holds(top) : layer.z + 1 < heights_.high && top > heights_.low;
  }

  /// Visits the faces, edges and points between eight octants that meet; those across or along
  /// `axis` only on request.
  template <typename Visit>
  void faces_across(const Layer& layer, int axis, const Meeting& cells, const Visit& visit) const {
    const int b = 1 << ((axis + 1) % 3);
    const int c = 1 << ((axis + 2) % 3);
    const int a = 1 << axis;
    for (const int k : {0, b, c, b | c}) {
      at_face(above(layer, k), axis, cells[k], cells[k | a], visit);
    }
  }
  template <typename Visit>
  void edges_along(const Layer& layer, int axis, const Meeting& cells, const Visit& visit) const {
    const int b = 1 << ((axis + 1) % 3);
    const int c = 1 << ((axis + 2) % 3);
    for (const int a : {0, 1 << axis}) {
      at_edge(above(layer, a), axis, {cells[a], cells[a | b], cells[a | c], cells[a | b | c]},
              visit);
    }
  }
  /// The layer of cell k of a meeting whose lower cells are in `layer`.
  static Layer above(const Layer& layer, int k) {
    return {layer.z + ((k >> 2) & 1) * layer.height, layer.height};
  }
  bool is_on_both_sides(const CellNode* cells, int count) const {
    unsigned sides = 0;
    for (int i = 0; i < count; ++i) sides |= cells[i].sides;
    return sides == kBothSides;
  }

  // Cells of this depth are left to the parts.
  static constexpr int kPartDepth = 3;
  static int depth_of(const CellNode* cells, int count) {
    int depth = -1;
    for (int i = 0; i < count; ++i) depth = std::max(depth, static_cast<int>(cells[i].depth));
    return depth;
  }

  const ContourTree& tree_;
  HeightRange heights_;
  std::vector<Part> parts_;
  // Receives the parts while they are collected.
  std::vector<Part>* found_ = nullptr;
};

template <typename Visit>
void DualCells::in_cell(const Layer& layer, const CellNode& cell, const Visit& visit) const {
  if (!cell.is_split || cell.sides != kBothSides || !is_wanted(layer, false)) return;
  if (found_ != nullptr && cell.depth == kPartDepth) {
    found_->push_back({Kind::kCell, layer, 0, {cell}});
    return;
  }
  const Layer lower = layer.half(0);
  Meeting octants;
  for (int o = 0; o < 8; ++o) octants[o] = tree_.octant(cell, o);
  for (int o = 0; o < 8; ++o) in_cell(above(lower, o), octants[o], visit);
  for (int axis = 0; axis < 3; ++axis) faces_across(lower, axis, octants, visit);
  for (int axis = 0; axis < 3; ++axis) edges_along(lower, axis, octants, visit);
  at_point(lower, octants, visit);
}

template <typename Visit>
void DualCells::at_face(const Layer& layer, int axis, const CellNode& low, const CellNode& high,
                        const Visit& visit) const {
  if (!low.is_split && !high.is_split) return;
  const std::array<CellNode, 2> pair = {low, high};
  if (!is_on_both_sides(pair.data(), 2) || !is_wanted(layer, axis == 2)) return;
  if (found_ != nullptr && depth_of(pair.data(), 2) == kPartDepth) {
    found_->push_back({Kind::kFace, layer, axis, {low, high}});
    return;
  }
  const int bit = 1 << axis;
  const Layer lower = layer.half(axis == 2 ? 1 : 0);
  Meeting octants;
  for (int o = 0; o < 8; ++o) octants[o] = tree_.octant((o & bit) == 0 ? low : high, o ^ bit);
  faces_across(lower, axis, octants, visit);
  edges_along(lower, (axis + 1) % 3, octants, visit);
  edges_along(lower, (axis + 2) % 3, octants, visit);
  at_point(lower, octants, visit);
}

template <typename Visit>
void DualCells::at_edge(const Layer& layer, int axis, const std::array<CellNode, 4>& around,
                        const Visit& visit) const {
  bool has_split = false;
  for (const CellNode& cell : around) has_split = has_split || cell.is_split;
  if (!has_split || !is_on_both_sides(around.data(), 4) || !is_wanted(layer, axis != 2)) return;
  if (found_ != nullptr && depth_of(around.data(), 4) == kPartDepth) {
    found_->push_back({Kind::kEdge, layer, axis, {around[0], around[1], around[2], around[3]}});
    return;
  }
  const int b = (axis + 1) % 3;
  const int c = (axis + 2) % 3;
  const Layer lower = layer.half(axis == 2 ? 0 : 1);
  Meeting octants;
  for (int o = 0; o < 8; ++o) {
    const int k = ((o >> b) & 1) | (((o >> c) & 1) << 1);
    octants[o] = tree_.octant(around[k], o ^ (1 << b) ^ (1 << c));
  }
  edges_along(lower, axis, octants, visit);
  at_point(lower, octants, visit);
}

template <typename Visit>
void DualCells::at_point(const Layer& layer, Meeting cells, const Visit& visit) const {
  if (!is_on_both_sides(cells.data(), 8) || !is_wanted(layer, true)) return;
  if (found_ != nullptr) {
    found_->push_back({Kind::kPoint, layer, 0, cells});
    return;
  }
  for (bool has_split = true; has_split;) {
    has_split = false;
    for (int i = 0; i < 8; ++i) {
      cells[i] = tree_.octant(cells[i], 7 ^ i);
      has_split = has_split || cells[i].is_split;
    }
  }
  if (is_on_both_sides(cells.data(), 8)) visit(cells);
}

inline DualCells::DualCells(const ContourTree& tree, const HeightRange& heights)
    : tree_(tree), heights_(heights) {
  std::vector<Part> found;
  found_ = &found;
  const auto nothing = [](const Meeting&) {};
  const CellNode root = tree.root();
  const CellNode outside = kSurroundings;
  const int side = 1 << tree.cells().depth();
  const Layer within = {0, side};
  const Layer below = {-side, side};
  // Each cell around an edge or a corner of the root counts as a separate cell.
  const auto surroundings = [](std::size_t number) {
    CellNode cell = kSurroundings;
    cell.block = static_cast<std::uint32_t>(number);
    return cell;
  };
  in_cell(within, root, nothing);
  for (int axis = 0; axis < 3; ++axis) {
    at_face(axis == 2 ? below : within, axis, outside, root, nothing);
    at_face(within, axis, root, outside, nothing);
    // Among the cells around an edge, this bit marks the upper ones.
    const std::size_t upper = axis == 0 ? 2 : 1;
    for (std::size_t k = 0; k < 4; ++k) {
      std::array<CellNode, 4> around;
      for (std::size_t i = 0; i < 4; ++i) around[i] = i == k ? root : surroundings(i);
      at_edge(axis != 2 && (k & upper) != 0 ? below : within, axis, around, nothing);
    }
  }
  for (std::size_t i = 0; i < 8; ++i) {
    Meeting cells;
    for (std::size_t j = 0; j < 8; ++j) cells[j] = i == j ? root : surroundings(j);
    at_point((i & 4) != 0 ? below : within, cells, nothing);
  }
  found_ = nullptr;
  parts_ = std::move(found);
}

}  // namespace prefilter
