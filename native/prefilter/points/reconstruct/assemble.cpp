// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/points/reconstruct/assemble.h"

#include <algorithm>
#include <bit>
#include <utility>

#include "prefilter/geometry/spatial/morton.h"

namespace prefilter {
namespace {

// Selects the blocks of a tree that lie near a slab.
class Window {
 public:
  // `low` to `high` are the slab's heights in finest cells. Blocks within `octants` of their own
  // octant sides are selected: at least two, but at most `most` finest cells away.
  Window(int low, int high, int depth, int octants, int most)
      : low_(low), high_(high), depth_(depth), octants_(octants), most_(most) {}
  bool holds(std::uint64_t place, int node_depth) const {
    const int shift = depth_ - node_depth;
    const int margin = std::max(1 << shift, std::min(octants_ << shift >> 1, most_));
    const int z = morton_cell(place)[2];
    return z << shift < high_ + margin && (z + 1) << shift > low_ - margin;
  }

 private:
  int low_;
  int high_;
  int depth_;
  int octants_;
  int most_;
};

CellTree assemble_within(const Window& window, const CoarseTree& coarse, const SlabTrees& trees,
                         int slab, int depth, bool is_solved, BlockSources* sources) {
  const int top = static_cast<int>(coarse.tree.levels.size());
  CellTree result;
  result.root = coarse.root;
  result.levels.resize(static_cast<std::size_t>(depth));
  const auto continued = [&](std::size_t number) {
    const CoarseTree::Continuation& continuation = coarse.continuations[number];
    const FluxTree* tree = trees[static_cast<std::size_t>(continuation.slab - slab + 1)];
    return BlockSource{tree->levels.data(), continuation.block};
  };
  std::vector<BlockSource> blocks;
  if (top > 0) {
    blocks.push_back({coarse.tree.levels.data(), 0});
  } else {
    blocks.push_back(continued(0));
  }
  for (int k = 0; k < depth; ++k) {
    TreeLevel& level = result.levels[static_cast<std::size_t>(k)];
    level.blocks.reserve(blocks.size());
    level.split.reserve(blocks.size());
    std::vector<BlockSource> next;
    for (const BlockSource& source : blocks) {
      const TreeLevel& from = source.level->blocks;
      const std::uint64_t place = source.level->places[source.block];
      unsigned split = from.split[source.block];
      std::size_t child = from.first[source.block];
      for (unsigned bits = split; bits != 0U; bits &= bits - 1U, ++child) {
        const int o = std::countr_zero(bits);
        if (!window.holds(place << 3U | static_cast<std::uint64_t>(o), k + 1)) {
          split &= ~(1U << o);
        } else if (k + 1 == top) {
          next.push_back(continued(child));
        } else {
          next.push_back({source.level + 1, child});
        }
      }
      const std::vector<OctantValues>& solved = source.level->solved;
      level.blocks.push_back(is_solved && !solved.empty() ? solved[source.block]
                                                          : from.blocks[source.block]);
      level.split.push_back(static_cast<std::uint8_t>(split));
    }
    link_blocks(&level);
    if (sources != nullptr) sources->push_back(std::move(blocks));
    blocks = std::move(next);
  }
  return result;
}

}  // namespace

CellTree assemble(const CoarseTree& coarse, const SlabTrees& trees, int slab, int depth,
                  int octants, float scale) {
  const int shift = depth - static_cast<int>(coarse.tree.levels.size());
  const Window window(slab << shift, (slab + 1) << shift, depth, octants, 1 << shift);
  CellTree result = assemble_within(window, coarse, trees, slab, depth, true, nullptr);
  result.root *= scale;
  for (TreeLevel& level : result.levels) {
    for (OctantValues& block : level.blocks) {
      for (float& value : block) value *= scale;
    }
  }
  return result;
}

CellTree assemble_unsolved(const CoarseTree& coarse, const SlabTrees& trees, int slab, int depth,
                           BlockSources* sources) {
  constexpr int kOctants = 8;
  const int shift = depth - static_cast<int>(coarse.tree.levels.size());
  const Window window(slab << shift, (slab + 1) << shift, depth, kOctants, 1 << shift);
  return assemble_within(window, coarse, trees, slab, depth, false, sources);
}

}  // namespace prefilter
