// SPDX-License-Identifier: GPL-3.0-or-later

// The pruned leaves and sample areas of section 4.2, as sample_slab.h corrects them, for the
// samples of the D4 basis.
#include "prefilter/points/reconstruct/d4_leaves.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

namespace prefilter {

SlabLeaves find_slab_leaves(const Slabs& slabs, int s) {
  const SampleSlab& slab = *slabs.samples(s);
  const SampleSlab& whole = slabs.whole;
  const int depth = slab.depth();
  const SampleLevel& finest = slab.at(depth);
  SlabLeaves result;
  result.leaf = finest.leaf;
  result.area.resize(finest.size());
  std::vector<std::uint8_t> counts(finest.size());
  for (std::size_t i = 0; i < finest.size(); ++i) {
    const int leaf = finest.leaf[i];
    if (leaf < 0) {
      result.left_out += static_cast<double>(finest.samples.cells[i].weight);
      continue;
    }
    std::size_t at = i;
    int k = depth;
    for (; k > std::max(leaf, slab.top); --k) at = slab.at(k).parents[at];
    const SampleLevel* level = &slab.at(k);
    if (leaf < slab.top) {
      at += slabs.offsets[static_cast<std::size_t>(s)];
      for (; k > leaf; --k) at = whole.at(k).parents[at];
      level = &whole.at(k);
    }
    result.area[i] = std::ldexp(level->unit_area[at], 2 * (leaf - depth));
    counts[i] = result.area[i] > 0.0F ? 1 : 0;
  }
  result.flags = find_leaf_flags(slab, counts, result.leaf);
  return result;
}

LeafFlags find_leaf_flags(const SampleSlab& slab, const std::vector<std::uint8_t>& counts,
                          const std::vector<std::int8_t>& leaf) {
  LeafFlags result(slab.levels.size());
  std::vector<std::int8_t> deepest(counts.size());
  for (std::size_t i = 0; i < deepest.size(); ++i) {
    deepest[i] = counts[i] != 0 ? leaf[i] : std::int8_t{-1};
  }
  for (int k = slab.depth();; --k) {
    std::vector<std::uint8_t>& flags = result[static_cast<std::size_t>(k - slab.top)];
    flags.resize(deepest.size());
    for (std::size_t i = 0; i < deepest.size(); ++i) flags[i] = deepest[i] >= k ? 1 : 0;
    if (k == slab.top) return result;
    std::vector<std::int8_t> above(slab.at(k - 1).size(), -1);
    for (std::size_t i = 0; i < deepest.size(); ++i) {
      std::int8_t& most = above[slab.at(k).parents[i]];
      most = std::max(most, deepest[i]);
    }
    deepest = std::move(above);
  }
}

LeafFlags find_whole_flags(const Slabs& slabs, std::span<const SlabLeaves> leaves) {
  const int top = slabs.top();
  std::vector<std::uint8_t> counts;
  for (const SlabLeaves& each : leaves) {
    counts.insert(counts.end(), each.flags.front().begin(), each.flags.front().end());
  }
  std::vector<std::int8_t> leaf(counts.size(), static_cast<std::int8_t>(top));
  for (std::size_t i = 0; i < counts.size(); ++i) {
    if (counts[i] != 0) continue;
    // The cell's samples count in larger cells, or are outliers.
    leaf[i] = slabs.whole.at(top).leaf[i];
    counts[i] = leaf[i] >= 0 ? 1 : 0;
  }
  return find_leaf_flags(slabs.whole, counts, leaf);
}

}  // namespace prefilter
