// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/reconstruct/assemble.h"

#include <bit>
#include <utility>

#include "prefilter/spatial/morton.h"

namespace prefilter {
namespace {

struct BlockOf {
  const NodeLevel* level;
  std::size_t block;
};

// Which blocks of a tree a slab needs.
class Window {
 public:
  Window(int low, int high, int depth) : low_(low), high_(high), depth_(depth) {}
  bool holds(std::uint64_t place, int node_depth) const {
    const int shift = depth_ - node_depth;
    const int margin = 1 << shift;  // two octants
    const int z = morton_cell(place)[2];
    return z << shift < high_ + margin && (z + 1) << shift > low_ - margin;
  }

 private:
  int low_;
  int high_;
  int depth_;
};

}  // namespace

CellTree assemble(const CoarseTree& coarse, const SlabTrees& trees, int slab, int depth,
                  float scale) {
  const int top = static_cast<int>(coarse.tree.levels.size());
  const Window window(slab << (depth - top), (slab + 1) << (depth - top), depth);
  CellTree result;
  result.root = scale * coarse.root;
  result.levels.resize(static_cast<std::size_t>(depth));
  const auto continued = [&](std::size_t number) {
    const CoarseTree::Continuation& found = coarse.continuations[number];
    const FluxTree* tree = trees[static_cast<std::size_t>(found.slab - slab + 1)];
    return BlockOf{tree->levels.data(), found.block};
  };
  std::vector<BlockOf> blocks;
  if (top > 0) {
    blocks.push_back({coarse.tree.levels.data(), 0});
  } else {
    blocks.push_back(continued(0));
  }
  for (int k = 0; k < depth; ++k) {
    TreeLevel& level = result.levels[static_cast<std::size_t>(k)];
    level.blocks.reserve(blocks.size());
    level.split.reserve(blocks.size());
    std::vector<BlockOf> next;
    for (const BlockOf& found : blocks) {
      const TreeLevel& from = found.level->blocks;
      const std::uint64_t place = found.level->places[found.block];
      unsigned split = from.split[found.block];
      std::size_t child = from.first[found.block];
      for (unsigned bits = split; bits != 0U; bits &= bits - 1U, ++child) {
        const int o = std::countr_zero(bits);
        if (!window.holds(place << 3U | static_cast<std::uint64_t>(o), k + 1)) {
          split &= ~(1U << o);
        } else if (k + 1 == top) {
          next.push_back(continued(child));
        } else {
          next.push_back({found.level + 1, child});
        }
      }
      level.blocks.push_back(from.blocks[found.block]);
      for (float& value : level.blocks.back()) value *= scale;
      level.split.push_back(static_cast<std::uint8_t>(split));
    }
    link_blocks(&level);
    blocks = std::move(next);
  }
  return result;
}

}  // namespace prefilter
