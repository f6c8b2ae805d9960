// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/reconstruct/d4_function.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>

#include "prefilter/base/parallel.h"
#include "prefilter/base/radix_sort.h"
#include "prefilter/reconstruct/gather_samples.h"
#include "prefilter/spatial/morton.h"
#include "prefilter/wavelet/d4_transform.h"

namespace prefilter {
namespace {

// Of a slab's finest cells: where their samples count, and the area of a unit of their weight in
// sides of that leaf squared; 0 for those that are left out.
struct LeafAreas {
  std::vector<std::int8_t> leaf;
  std::vector<float> area;
  double left_out = 0.0;
};

LeafAreas leaf_areas(const Slabs& slabs, std::size_t s) {
  const SampleSlab& slab = *slabs.samples(static_cast<int>(s));
  const SampleSlab& whole = slabs.whole;
  const int depth = slab.depth();
  const SampleLevel& finest = slab.at(depth);
  LeafAreas result;
  result.leaf = finest.leaf;
  result.area.resize(finest.size());
  for (std::size_t i = 0; i < finest.size(); ++i) {
    const int leaf = finest.leaf[i];
    if (leaf < slabs.least_leaf) {
      result.left_out += static_cast<double>(finest.samples.cells[i].weight);
      continue;
    }
    std::size_t at = i;
    int k = depth;
    for (; k > std::max(leaf, slab.top); --k) at = slab.at(k).parents[at];
    const SampleLevel* level = &slab.at(k);
    if (leaf < slab.top) {
      at += slabs.offsets[s];
      for (; k > leaf; --k) at = whole.at(k).parents[at];
      level = &whole.at(k);
    }
    result.area[i] = std::ldexp(level->unit_area[at], 2 * (leaf - depth));
  }
  return result;
}

struct CoarseSample {
  int depth;
  Vector3 point;
  std::array<float, 3> area;
};

// Adds the samples of a batch.
class SampleAdder {
 public:
  SampleAdder(const SampleGrid& grid, const Slabs& slabs, const std::vector<LeafAreas>& areas,
              std::vector<d4::Differences>* differences)
      : grid_(grid), slabs_(slabs), areas_(areas), differences_(*differences) {}

  void add(const PointBatch& batch, int threads) {
    const std::vector<std::uint64_t>& order = order_.sort(batch, grid_);
    const std::size_t count = areas_.size();
    const int height = (1 << grid_.depth) / static_cast<int>(count);
    std::vector<std::size_t> begins;
    for (std::size_t s = 0; s <= count; ++s) {
      const std::uint64_t first = cell_key({-1, -1, static_cast<std::int32_t>(s) * height})
                                  << PointOrder::kBatchBits;
      begins.push_back(static_cast<std::size_t>(
          std::lower_bound(order.begin(), order.end(), first) - order.begin()));
    }
    std::vector<std::vector<CoarseSample>> coarse(count);
    std::vector<double> volumes(count);
    // A slab's samples reach into the one below: every other one at a time.
    for (std::size_t parity = 0; parity < 2; ++parity) {
      parallel_for(static_cast<std::int64_t>((count + 1 - parity) / 2), threads, Progress(),
                   [&](std::int64_t i) {
                     const std::size_t s = 2 * static_cast<std::size_t>(i) + parity;
                     volumes[s] = add_slab(batch, order, begins[s], begins[s + 1], s, &coarse[s]);
                   });
    }
    for (std::size_t s = 0; s < count; ++s) {
      volume_ += volumes[s];
      for (const CoarseSample& sample : coarse[s]) {
        d4::add_sample(sample.point, sample.area,
                       &differences_[static_cast<std::size_t>(sample.depth)]);
      }
    }
  }

  double volume() const { return volume_; }

 private:
  double add_slab(const PointBatch& batch, const std::vector<std::uint64_t>& order,
                  std::size_t begin, std::size_t end, std::size_t s,
                  std::vector<CoarseSample>* coarse) {
    const int depth = grid_.depth;
    const std::vector<SampleCell>& cells =
        slabs_.samples(static_cast<int>(s))->at(depth).samples.cells;
    const double middle = std::ldexp(0.5, depth);
    double volume = 0.0;
    std::size_t at = 0;
    for (std::size_t i = begin; i < end; ++i) {
      const CellKey key = PointOrder::key(order[i]);
      if (cells[at].key != key) {
        at = static_cast<std::size_t>(
            std::lower_bound(cells.begin() + static_cast<std::ptrdiff_t>(at), cells.end(), key,
                             [](const SampleCell& cell, CellKey k) { return cell.key < k; }) -
            cells.begin());
      }
      const float area = areas_[s].area[at];
      if (!(area > 0.0F)) continue;
      const std::size_t index = PointOrder::index(order[i]);
      std::array<float, 3> normal = grid_.turned(weighted_normal(batch, index));
      for (float& x : normal) x *= area;
      const Vector3 p = grid_.in_cells(batch.positions[index]);
      const int leaf = areas_[s].leaf[at];
      const double scale = std::ldexp(1.0, leaf - depth);
      for (std::size_t a = 0; a < 3; ++a) {
        volume += static_cast<double>(normal[a]) * (p[a] - middle) / (scale * scale);
      }
      if (leaf == depth) {
        d4::add_sample(p, normal, &differences_.back());
      } else {
        coarse->push_back({leaf, {p[0] * scale, p[1] * scale, p[2] * scale}, normal});
      }
    }
    return volume;
  }

  const SampleGrid& grid_;
  const Slabs& slabs_;
  const std::vector<LeafAreas>& areas_;
  std::vector<d4::Differences>& differences_;
  PointOrder order_;
  double volume_ = 0.0;
};

// Of the cells of a level, the cells that are to be split: which hold these, or a neighbour, as
// places along the Morton curve of the depth above. Only those from `low` up to `high` there.
class SplitFinder {
 public:
  SplitFinder(int depth, int low, int high) : side_(1 << depth >> 1), low_(low), high_(high) {}

  void add(const CellPosition& cell) {
    std::array<std::array<std::int32_t, 2>, 3> parents;
    for (std::size_t a = 0; a < 3; ++a) {
      const std::int32_t p = cell[a] >> 1;
      parents[a] = {p, (cell[a] & 1) != 0 ? p + 1 : p - 1};
    }
    for (const std::int32_t z : parents[2]) {
      if (z < low_ || z >= high_) continue;
      for (const std::int32_t y : parents[1]) {
        if (y < 0 || y >= side_) continue;
        for (const std::int32_t x : parents[0]) {
          if (x >= 0 && x < side_) places_.push_back(morton_index({x, y, z}));
        }
      }
    }
    if (places_.size() > 2 * compact_size_ + (1U << 16U)) compact();
  }

  std::vector<std::uint64_t> take() {
    compact();
    return std::move(places_);
  }

 private:
  void compact() {
    std::vector<std::uint64_t> other;
    radix_sort(&places_, 0, 3 * kMaxTreeDepth, &other);
    places_.erase(std::unique(places_.begin(), places_.end()), places_.end());
    compact_size_ = places_.size();
  }

  std::int32_t side_;
  std::int32_t low_;
  std::int32_t high_;
  std::size_t compact_size_ = 0;
  std::vector<std::uint64_t> places_;
};

// Whether cells hold leaves as deep as they are, level by level from the finest.
std::vector<std::vector<std::uint8_t>> holds_leaves(const SampleSlab& slab,
                                                    const std::vector<std::uint8_t>& finest_counts,
                                                    const std::vector<std::int8_t>& leaf) {
  std::vector<std::vector<std::uint8_t>> result(slab.levels.size());
  std::vector<std::int8_t> deepest(finest_counts.size());
  for (std::size_t i = 0; i < deepest.size(); ++i) {
    deepest[i] = finest_counts[i] != 0 ? leaf[i] : std::int8_t{-1};
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

using Flags = std::vector<std::vector<std::uint8_t>>;

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

// Sets `split` and `first`, where the next level's places are these; they may be of several parts.
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

BrickPosition brick_of(std::uint64_t place) {
  const CellPosition node = morton_cell(place);
  return {node[0] >> 1, node[1] >> 1, node[2] >> 1};
}

// The bricks of means that the values of a level's blocks depend on.
void add_needed(const NodeLevel& level, std::vector<BrickPosition>* needed) {
  BrickPosition last = {-1, -1, -1};
  for (const std::uint64_t place : level.places) {
    const BrickPosition b = brick_of(place);
    if (b == last) continue;
    last = b;
    for (int corner = 0; corner < 8; ++corner) {
      needed->push_back({b[0] - (corner & 1), b[1] - ((corner >> 1) & 1), b[2] - (corner >> 2)});
    }
  }
}

void fill_values(const d4::Means& means, NodeLevel* level) {
  BrickPosition last = {-1, -1, -1};
  std::array<float, 64> values{};
  for (std::size_t b = 0; b < level->places.size(); ++b) {
    const BrickPosition brick = brick_of(level->places[b]);
    if (brick != last) values = d4::function_at(means, brick);
    last = brick;
    const CellPosition node = morton_cell(level->places[b]);
    for (std::size_t o = 0; o < 8; ++o) {
      const auto x = static_cast<std::size_t>(2 * (node[0] & 1)) + (o & 1);
      const auto y = static_cast<std::size_t>(2 * (node[1] & 1)) + ((o >> 1) & 1);
      const auto z = static_cast<std::size_t>(2 * (node[2] & 1)) + (o >> 2);
      level->blocks.blocks[b][o] = values[(z * 4 + y) * 4 + x];
    }
  }
}

}  // namespace

D4Function make_d4_function(PointSource* source, const SampleGrid& grid, const Slabs& slabs,
                            const Progress& progress, int threads) {
  const SampleSlab& whole = slabs.whole;
  const int depth = slabs.depth();
  const int top = slabs.top();
  const std::int64_t slab_count = slabs.count();
  const auto count_of_slabs = static_cast<std::size_t>(slab_count);
  std::vector<LeafAreas> areas(count_of_slabs);
  std::vector<Flags> flags(count_of_slabs);
  parallel_for(slab_count, threads, Progress(), [&](std::int64_t i) {
    const auto s = static_cast<std::size_t>(i);
    areas[s] = leaf_areas(slabs, s);
    std::vector<std::uint8_t> counts(areas[s].area.size());
    for (std::size_t c = 0; c < counts.size(); ++c) counts[c] = areas[s].area[c] > 0.0F ? 1 : 0;
    flags[s] = holds_leaves(*slabs.samples(static_cast<int>(i)), counts, areas[s].leaf);
  });

  std::vector<d4::Differences> differences;
  // Shards as high as slabs: those that two slabs write to are theirs.
  constexpr int kBrickBits = 2;
  const int shard_bits = std::max(depth - top - kBrickBits, 0);
  for (int k = 0; k <= depth; ++k) differences.emplace_back(k, shard_bits);
  SampleAdder adder(grid, slabs, areas, &differences);
  PointBatch batch;
  const auto count = static_cast<double>(source->count().value_or(0));
  std::size_t done = 0;
  source->rewind();
  while (source->read(PointOrder::kMostPoints, &batch)) {
    adder.add(batch, threads);
    done += batch.positions.size();
    if (count > 0.0)
      progress.part(0.0, 0.5).report(std::min(1.0, static_cast<double>(done) / count));
  }

  D4Function result;
  result.is_flipped = adder.volume() < 0.0;
  for (const LeafAreas& each : areas) result.left_out += each.left_out;
  result.trees.resize(count_of_slabs);
  parallel_for(slab_count, threads, progress.part(0.5, 0.55), [&](std::int64_t i) {
    const auto s = static_cast<std::size_t>(i);
    FluxTree& tree = result.trees[s];
    tree.top = top;
    for (int k = top + 1; k <= depth; ++k) {
      const int height = 1 << (k - top);
      const int low = static_cast<int>(s) * height;
      SplitFinder finder(k, low / 2, (low + height) / 2);
      for (std::size_t t = s > 0 ? s - 1 : 0; t < std::min(s + 2, count_of_slabs); ++t) {
        add_flagged(slabs.samples(static_cast<int>(t))->at(k),
                    flags[t][static_cast<std::size_t>(k - top)], low - 1, low + height + 1,
                    &finder);
      }
      tree.levels.push_back(node_level(finder.take()));
    }
    for (std::size_t k = 0; k + 1 < tree.levels.size(); ++k) {
      link(tree.levels[k + 1].places, &tree.levels[k]);
    }
    if (!tree.levels.empty()) link({}, &tree.levels.back());
  });

  // The levels above the slabs' are those of all.
  std::vector<std::uint8_t> counts;
  std::vector<std::int8_t> leaf;
  for (std::size_t s = 0; s < count_of_slabs; ++s) {
    counts.insert(counts.end(), flags[s].front().begin(), flags[s].front().end());
  }
  leaf.assign(counts.size(), static_cast<std::int8_t>(top));
  for (std::size_t i = 0; i < counts.size(); ++i) {
    if (counts[i] != 0) continue;
    // Its samples count in larger cells, if at all.
    leaf[i] = whole.at(top).leaf[i];
    counts[i] = leaf[i] >= slabs.least_leaf ? 1 : 0;
  }
  const Flags whole_flags = holds_leaves(whole, counts, leaf);
  FluxTree& coarse = result.coarse.tree;
  for (int k = 1; k <= top; ++k) {
    SplitFinder finder(k, 0, 1 << k);
    add_flagged(whole.at(k), whole_flags[static_cast<std::size_t>(k)], 0, 1 << k, &finder);
    coarse.levels.push_back(node_level(finder.take()));
  }
  std::vector<std::uint64_t> firsts;
  for (const FluxTree& tree : result.trees) {
    firsts.insert(firsts.end(), tree.levels.front().places.begin(),
                  tree.levels.front().places.end());
  }
  std::sort(firsts.begin(), firsts.end());
  for (std::size_t k = 0; k < coarse.levels.size(); ++k) {
    link(k + 1 < coarse.levels.size() ? coarse.levels[k + 1].places : firsts, &coarse.levels[k]);
  }
  std::vector<std::uint32_t> next(count_of_slabs);
  for (const std::uint64_t place : firsts) {
    const auto slab = static_cast<std::size_t>(morton_cell(place)[2]);
    result.coarse.continuations.push_back({static_cast<int>(slab), next[slab]++});
  }

  std::vector<std::vector<BrickPosition>> needed(static_cast<std::size_t>(depth) + 1);
  for (std::size_t k = 0; k < coarse.levels.size(); ++k)
    add_needed(coarse.levels[k], &needed[k + 1]);
  for (const FluxTree& tree : result.trees) {
    for (std::size_t k = 0; k < tree.levels.size(); ++k) {
      add_needed(tree.levels[k], &needed[static_cast<std::size_t>(top) + k + 1]);
    }
  }
  const std::vector<d4::Means> means =
      d4::transform(std::move(differences), std::move(needed), progress.part(0.55, 0.9), threads);
  for (std::size_t k = 0; k < coarse.levels.size(); ++k)
    fill_values(means[k + 1], &coarse.levels[k]);
  parallel_for(slab_count, threads, progress.part(0.9, 1.0), [&](std::int64_t i) {
    FluxTree& tree = result.trees[static_cast<std::size_t>(i)];
    for (std::size_t k = 0; k < tree.levels.size(); ++k) {
      fill_values(means[static_cast<std::size_t>(top) + k + 1], &tree.levels[k]);
    }
  });
  return result;
}

}  // namespace prefilter
