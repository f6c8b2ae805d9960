// SPDX-License-Identifier: GPL-3.0-or-later

// Equation 4.2 in the D4 basis (section 4.4): adds each sample to the wavelet differences of each
// depth up to its leaf, and evaluates Equation 3.4 at the centers of the cells.
#include "prefilter/points/reconstruct/d4_function.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "prefilter/base/parallel.h"
#include "prefilter/geometry/spatial/morton.h"
#include "prefilter/points/reconstruct/d4_leaves.h"
#include "prefilter/points/reconstruct/d4_trees.h"
#include "prefilter/points/reconstruct/gather_samples.h"
#include "prefilter/wavelet/d4_transform.h"

namespace prefilter {
namespace {

struct CoarseSample {
  int depth;
  Vector3 point;
  std::array<float, 3> area;
};

// Adds the samples of batches to the wavelet differences of each depth.
class SampleAdder {
 public:
  SampleAdder(const SampleGrid& grid, const Slabs& slabs, const std::vector<SlabLeaves>& leaves,
              std::vector<d4::Differences>* differences)
      : grid_(grid), slabs_(slabs), leaves_(leaves), differences_(*differences) {}

  void add(const PointBatch& batch, int threads) {
    const std::vector<std::uint64_t>& order = order_.sort(batch, grid_);
    const std::size_t count = leaves_.size();
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
    // A slab's samples also change the slab below, so even and odd slabs take turns.
    for (std::size_t parity = 0; parity < 2; ++parity) {
      parallel_for(static_cast<std::int64_t>((count + 1 - parity) / 2), Run(threads),
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
      const float area = leaves_[s].area[at];
      if (!(area > 0.0F)) continue;
      const std::size_t index = PointOrder::index(order[i]);
      std::array<float, 3> normal = grid_.turned(weighted_normal(batch, index));
      for (float& x : normal) x *= area;
      const Vector3 p = grid_.in_cells(batch.positions[index]);
      const int leaf = leaves_[s].leaf[at];
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
  const std::vector<SlabLeaves>& leaves_;
  std::vector<d4::Differences>& differences_;
  PointOrder order_;
  double volume_ = 0.0;
};

BrickPosition brick_of(std::uint64_t place) {
  const CellPosition node = morton_cell(place);
  return {node[0] >> 1, node[1] >> 1, node[2] >> 1};
}

// Collects the bricks of means on which the values of a level's blocks depend.
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

// Sums over the samples of all slabs.
struct SampleSums {
  std::vector<d4::Differences> differences;  // of each depth
  double volume = 0.0;                       // signed; below 0 where most normals point inward
};

SampleSums add_samples(PointSource* source, const SampleGrid& grid, const Slabs& slabs,
                       const std::vector<SlabLeaves>& leaves, const Run& run) {
  SampleSums sums;
  // Shards are as high as slabs, so each is written by two slabs at most.
  constexpr int kBrickBits = 2;
  const int shard_bits = std::max(slabs.depth() - slabs.top() - kBrickBits, 0);
  for (int k = 0; k <= slabs.depth(); ++k) sums.differences.emplace_back(k, shard_bits);
  SampleAdder adder(grid, slabs, leaves, &sums.differences);
  PointBatch batch;
  const auto count = static_cast<double>(source->count().value_or(0));
  std::size_t done = 0;
  source->rewind();
  while (source->read(PointOrder::kMaxPoints, &batch)) {
    adder.add(batch, run.threads());
    done += batch.positions.size();
    if (count > 0.0) run.report(std::min(1.0, static_cast<double>(done) / count));
  }
  sums.volume = adder.volume();
  return sums;
}

// Calls visit(level, k) for every level of all trees; the blocks of `level` split cells of depth k.
template <typename Visit>
void for_levels(D4Function* function, int top, const Visit& visit) {
  std::vector<NodeLevel>& coarse = function->coarse.tree.levels;
  for (std::size_t k = 0; k < coarse.size(); ++k) visit(&coarse[k], k);
  for (FluxTree& tree : function->trees) {
    for (std::size_t k = 0; k < tree.levels.size(); ++k) {
      visit(&tree.levels[k], static_cast<std::size_t>(top) + k);
    }
  }
}

}  // namespace

D4Function make_d4_function(PointSource* source, const SampleGrid& grid, const Slabs& slabs,
                            const Run& run) {
  const auto count = static_cast<std::size_t>(slabs.count());
  std::vector<SlabLeaves> leaves(count);
  parallel_for(slabs.count(), Run(run.threads()), [&](std::int64_t s) {
    leaves[static_cast<std::size_t>(s)] = find_slab_leaves(slabs, static_cast<int>(s));
  });
  const Stages stages(run, {10, 1, 7, 2});
  SampleSums sums = add_samples(source, grid, slabs, leaves, stages[0]);
  D4Function result;
  result.is_flipped = sums.volume < 0.0;
  for (const SlabLeaves& each : leaves) result.left_out += each.left_out;
  result.trees.resize(count);
  parallel_for(slabs.count(), stages[1], [&](std::int64_t s) {
    result.trees[static_cast<std::size_t>(s)] = split_slab(slabs, leaves, static_cast<int>(s));
  });
  result.coarse = split_whole(slabs, find_whole_flags(slabs, leaves), result.trees);

  std::vector<std::vector<BrickPosition>> needed(static_cast<std::size_t>(slabs.depth()) + 1);
  std::vector<std::pair<NodeLevel*, std::size_t>> levels;
  for_levels(&result, slabs.top(), [&](NodeLevel* level, std::size_t k) {
    add_needed(*level, &needed[k + 1]);
    levels.emplace_back(level, k + 1);
  });
  const std::vector<d4::Means> means =
      d4::transform(std::move(sums.differences), std::move(needed), stages[2]);
  parallel_for(static_cast<std::int64_t>(levels.size()), stages[3], [&](std::int64_t i) {
    const auto& [level, k] = levels[static_cast<std::size_t>(i)];
    fill_values(means[k], level);
  });
  return result;
}

}  // namespace prefilter
