// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/points/reconstruct/d4_trees.h"

#include <algorithm>
#include <cstddef>
#include <utility>

#include "prefilter/geometry/spatial/morton.h"
#include "prefilter/points/reconstruct/split_finder.h"

namespace prefilter {
namespace {

void add_flagged(const SampleLevel& level, const std::vector<std::uint8_t>& flags, int low,
                 int high, SplitFinder* finder) {
  for (std::size_t i = 0; i < level.size(); ++i) {
    const CellPosition at = cell_position(level.samples.cells[i].key);
    if (flags[i] != 0 && at[2] >= low && at[2] < high) finder->add(at);
  }
}

NodeLevel node_level(std::vector<std::uint64_t> places) {
  NodeLevel level;
  level.places = std::move(places);
  level.blocks.blocks.resize(level.places.size());
  level.blocks.split.resize(level.places.size());
  return level;
}

// Sets `split` and `first` from the places of the next level, which may span several parts.
void link(const std::vector<std::uint64_t>& next, NodeLevel* level) {
  std::size_t child = 0;
  for (std::size_t b = 0; b < level->places.size(); ++b) {
    while (child < next.size() && next[child] >> 3U < level->places[b]) ++child;
    for (; child < next.size() && next[child] >> 3U == level->places[b]; ++child) {
      level->blocks.split[b] |= static_cast<std::uint8_t>(1U << (next[child] & 7U));
    }
  }
  link_blocks(&level->blocks);
}

}  // namespace

FluxTree split_slab(const Slabs& slabs, std::span<const SlabLeaves> leaves, int s) {
  FluxTree tree;
  tree.top = slabs.top();
  for (int k = slabs.top() + 1; k <= slabs.depth(); ++k) {
    const int height = 1 << (k - slabs.top());
    const int low = s * height;
    SplitFinder finder(k, low / 2, (low + height) / 2);
    for (int t = std::max(s - 1, 0); t < std::min(s + 2, slabs.count()); ++t) {
      const LeafFlags& flags = leaves[static_cast<std::size_t>(t)].flags;
      add_flagged(slabs.samples(t)->at(k), flags[static_cast<std::size_t>(k - slabs.top())],
                  low - 1, low + height + 1, &finder);
    }
    tree.levels.push_back(node_level(finder.take()));
  }
  for (std::size_t k = 0; k + 1 < tree.levels.size(); ++k) {
    link(tree.levels[k + 1].places, &tree.levels[k]);
  }
  if (!tree.levels.empty()) link({}, &tree.levels.back());
  return tree;
}

CoarseTree split_whole(const Slabs& slabs, const LeafFlags& flags,
                       std::span<const FluxTree> trees) {
  CoarseTree result;
  std::vector<NodeLevel>& levels = result.tree.levels;
  for (int k = 1; k <= slabs.top(); ++k) {
    SplitFinder finder(k, 0, 1 << (k - 1));
    add_flagged(slabs.whole.at(k), flags[static_cast<std::size_t>(k)], 0, 1 << k, &finder);
    levels.push_back(node_level(finder.take()));
  }
  std::vector<std::uint64_t> firsts;
  for (const FluxTree& tree : trees) {
    const std::vector<std::uint64_t>& places = tree.levels.front().places;
    firsts.insert(firsts.end(), places.begin(), places.end());
  }
  std::sort(firsts.begin(), firsts.end());
  for (std::size_t k = 0; k < levels.size(); ++k) {
    link(k + 1 < levels.size() ? levels[k + 1].places : firsts, &levels[k]);
  }
  std::vector<std::uint32_t> next(trees.size());
  for (const std::uint64_t place : firsts) {
    const auto slab = static_cast<std::size_t>(morton_cell(place)[2]);
    result.continuations.push_back({static_cast<int>(slab), next[slab]++});
  }
  return result;
}

}  // namespace prefilter
