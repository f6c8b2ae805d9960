// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/wavelet/fine_border.h"

#include "prefilter/wavelet/tree_builder.h"

namespace prefilter {
namespace {

// A cell of a tree, or within a leaf of it, and the faces of the root that it touches: bit 2 a for
// the low face across axis a, bit 2 a + 1 for the high one.
struct FineBorderCell {
  bool is_split;
  std::size_t block;
  float value;
  unsigned faces;
};

class BorderRule {
 public:
  explicit BorderRule(const CellTree& tree) : tree_(tree) {}

  FineBorderCell root() const { return {!tree_.levels.empty(), 0, tree_.root, 63}; }

  bool is_split(const FineBorderCell& cell, int depth) const {
    return cell.is_split || (cell.faces != 0 && cell.value > 0.0F && depth < tree_.depth());
  }

  float value(const FineBorderCell& cell, int /*depth*/) const { return cell.value; }

  FineBorderCell octant(const FineBorderCell& cell, int depth, int o) const {
    FineBorderCell result = cell;
    for (int axis = 0; axis < 3; ++axis) {
      const bool is_high = ((o >> axis) & 1) != 0;
      result.faces &= ~(is_high ? 1U << (2 * axis) : 2U << (2 * axis));
    }
    if (!cell.is_split) return result;
    const TreeLevel& level = tree_.levels[static_cast<std::size_t>(depth)];
    result.is_split = level.is_split(cell.block, o);
    result.block = result.is_split ? level.child(cell.block, o) : 0;
    result.value = level.blocks[cell.block][static_cast<std::size_t>(o)];
    return result;
  }

 private:
  const CellTree& tree_;
};
}  // namespace

CellTree with_fine_border(const CellTree& tree, const Run& run) {
  const BorderRule rule(tree);
  return build_tree(rule.root(), tree.depth(), rule, run);
}

}  // namespace prefilter
