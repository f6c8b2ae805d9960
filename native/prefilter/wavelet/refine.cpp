// SPDX-License-Identifier: GPL-3.0-or-later

// Two passes: the first splits partly full leaves along their surfaces; the second splits leaves
// adjacent to the other side of a surface, such as full leaves beside empty ones.
#include "prefilter/wavelet/refine.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

#include "prefilter/wavelet/leaf_surface.h"
#include "prefilter/wavelet/tree_builder.h"

namespace prefilter {
namespace {

// Value of a cell within a leaf that the surface intersects.
constexpr float kMixed = 0.5F;

// A cell of a tree, or within a leaf.
struct RefineCell {
  bool is_split;
  std::size_t block;
  float value;
  LeafPlace at;

  static RefineCell root_of(const CellTree& tree) {
    return {!tree.levels.empty(), 0, tree.root, {0, 0, 0}};
  }
  RefineCell octant(const CellTree& tree, int depth, int o) const {
    const TreeLevel& level = tree.levels[static_cast<std::size_t>(depth)];
    const bool splits = level.is_split(block, o);
    return {splits, splits ? level.child(block, o) : 0, level.blocks[block][o],
            octant_place(at, o)};
  }
};

// Splits leaves along their surfaces.
class SurfaceRule {
 public:
  struct Part {
    RefineCell cell;
    // Within a leaf with a surface: the surface, and the position among the leaf's cells of this
    // depth.
    std::optional<LeafSurface> surface;
    int leaf_depth;
    LeafPlace within;
  };

  SurfaceRule(const CellTree& tree, int depth) : tree_(tree), depth_(depth) {}

  Part root() const { return part_of(RefineCell::root_of(tree_), 0); }

  bool is_split(const Part& part, int depth) const {
    if (!part.surface) return part.cell.is_split;
    return depth < depth_ && is_fraction(part.cell.value);
  }
  float value(const Part& part, int /*depth*/) const { return part.cell.value; }

  Part octant(const Part& part, int depth, int o) const {
    if (!part.surface) return part_of(part.cell.octant(tree_, depth, o), depth + 1);
    Part result = part;
    result.within = octant_place(part.within, o);
    const double side = std::ldexp(1.0, part.leaf_depth - depth - 1);
    Box box;
    for (int a = 0; a < 3; ++a) {
      box.low[a] = side * result.within[a];
      box.high[a] = side * (result.within[a] + 1);
    }
    if (depth + 1 == depth_) {
      constexpr double kNothing = 1e-7;
      const double share = part.surface->share(box);
      result.cell.value = static_cast<float>(share < kNothing ? 0.0 : share);
      return result;
    }
    result.cell.value = part.surface->uniform_value(box).value_or(kMixed);
    return result;
  }

 private:
  Part part_of(const RefineCell& cell, int depth) const {
    Part part{cell, std::nullopt, depth, {0, 0, 0}};
    if (!cell.is_split && depth < depth_ && is_fraction(cell.value)) {
      part.surface = LeafSurface::find(tree_, depth, cell.at, 1 << (depth_ - depth));
    }
    return part;
  }

  const CellTree& tree_;
  int depth_;
};

// Bits for the contents of leaves above the finest depth.
constexpr std::uint8_t kEmpty = 1;
constexpr std::uint8_t kFull = 2;
constexpr std::uint8_t kPartlyFull = 4;

std::uint8_t content_of(float value) {
  if (value <= 0.0F) return kEmpty;
  return value >= 1.0F ? kFull : kPartlyFull;
}

// For each block: the contents of its leaves coarser than a depth.
std::vector<std::vector<std::uint8_t>> coarse_contents(const CellTree& tree, int depth) {
  std::vector<std::vector<std::uint8_t>> contents(tree.levels.size());
  for (std::size_t k = tree.levels.size(); k-- > 0;) {
    const TreeLevel& level = tree.levels[k];
    contents[k].assign(level.size(), 0);
    const bool are_coarse = static_cast<int>(k) + 1 < depth;
    for (std::size_t b = 0; b < level.size(); ++b) {
      std::size_t child = level.first[b];
      for (int o = 0; o < 8; ++o) {
        if (level.is_split(b, o)) {
          contents[k][b] |= contents[k + 1][child++];
        } else if (are_coarse) {
          contents[k][b] |= content_of(level.blocks[b][static_cast<std::size_t>(o)]);
        }
      }
    }
  }
  return contents;
}

// Splits leaves coarser than a depth that share a face with the other side of a surface.
class SideRule {
 public:
  struct Node {
    bool is_split = false;
    int depth = -1;
    std::size_t block = 0;
    float value = 0.0F;
    std::uint8_t contents = kEmpty;
  };
  struct Part {
    Node node;
    std::array<Node, 6> neighbors;  // 2 a: across axis a at its low side; 2 a + 1: at its high side
  };

  SideRule(const CellTree& tree, int depth)
      : tree_(tree), depth_(depth), contents_(coarse_contents(tree, depth)) {}

  Part root() const {
    Part part;
    part.node = {!tree_.levels.empty(), 0, 0, tree_.root, 0};
    part.node.contents = part.node.is_split ? contents_[0][0] : leaf_contents(part.node);
    return part;
  }

  bool is_split(const Part& part, int depth) const {
    if (part.node.is_split) return true;
    if (depth >= depth_) return false;
    for (int face = 0; face < 6; ++face) {
      if (is_beside_other(part.node, part.neighbors[static_cast<std::size_t>(face)], face)) {
        return true;
      }
    }
    return false;
  }

  float value(const Part& part, int /*depth*/) const { return part.node.value; }

  Part octant(const Part& part, int /*depth*/, int o) const {
    Part result;
    result.node = octant_of(part.node, o);
    for (int face = 0; face < 6; ++face) {
      const int bit = 1 << (face / 2);
      const bool leaves = ((o & bit) != 0) == ((face & 1) != 0);
      const auto f = static_cast<std::size_t>(face);
      result.neighbors[f] = octant_of(leaves ? part.neighbors[f] : part.node, o ^ bit);
    }
    return result;
  }

 private:
  std::uint8_t leaf_contents(const Node& node) const {
    return node.depth < depth_ ? content_of(node.value) : std::uint8_t{0};
  }

  // The octants of a leaf are copies of the leaf.
  Node octant_of(const Node& node, int o) const {
    if (!node.is_split) return node;
    const auto k = static_cast<std::size_t>(node.depth);
    const TreeLevel& level = tree_.levels[k];
    Node result;
    result.is_split = level.is_split(node.block, o);
    result.depth = node.depth + 1;
    result.value = level.blocks[node.block][static_cast<std::size_t>(o)];
    if (result.is_split) {
      result.block = level.child(node.block, o);
      result.contents = contents_[k + 1][result.block];
    } else {
      result.contents = leaf_contents(result);
    }
    return result;
  }

  // Between a full and an empty leaf the surface is exactly at the face of the finer one, which
  // suffices if that has the required depth.
  bool is_beside_other(const Node& leaf, const Node& neighbor, int face) const {
    const bool is_uniform = !is_fraction(leaf.value);
    if (neighbor.is_split) {
      if (is_uniform && (neighbor.contents & ~content_of(leaf.value) & ~kPartlyFull) == 0) {
        return false;
      }
      const int axis = face / 2;
      for (int o = 0; o < 8; ++o) {
        // Octants at the face only.
        if (((o >> axis) & 1) == (face & 1)) continue;
        if (is_beside_other(leaf, octant_of(neighbor, o), face)) return true;
      }
      return false;
    }
    if (leaf.value == neighbor.value) return false;
    const bool is_coarse = neighbor.depth >= 0 && neighbor.depth < depth_;
    return !is_uniform || (is_coarse && !is_fraction(neighbor.value));
  }

  const CellTree& tree_;
  int depth_;
  std::vector<std::vector<std::uint8_t>> contents_;
};
}  // namespace

bool has_coarse_surface(const CellTree& tree) {
  for (std::size_t k = 0; k + 1 < tree.levels.size(); ++k) {
    const TreeLevel& level = tree.levels[k];
    for (std::size_t b = 0; b < level.size(); ++b) {
      for (int o = 0; o < 8; ++o) {
        if (is_fraction(level.blocks[b][static_cast<std::size_t>(o)]) && !level.is_split(b, o)) {
          return true;
        }
      }
    }
  }
  return false;
}

CellTree refined(const CellTree& tree, int depth, const Run& run) {
  const int most = std::max(depth, tree.depth());
  const SurfaceRule by_surface(tree, depth);
  const Stages stages(run, {7, 3});
  const CellTree split = build_tree(by_surface.root(), most, by_surface, stages[0]);
  const SideRule by_side(split, depth);
  return build_tree(by_side.root(), most, by_side, stages[1]);
}

}  // namespace prefilter
