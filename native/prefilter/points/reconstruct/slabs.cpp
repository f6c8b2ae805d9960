// SPDX-License-Identifier: GPL-3.0-or-later

// The streaming pass of section 4.3.2: a slab's tree is built, used by its neighbors and dropped.
#include "prefilter/points/reconstruct/slabs.h"

#include <algorithm>
#include <utility>

#include "prefilter/base/parallel.h"
#include "prefilter/base/run.h"
#include "prefilter/points/reconstruct/plane_patches.h"

namespace prefilter {

Slabs::Slabs(SampleStore* store, int depth, int top, std::size_t attribute_count, bool keeps_all,
             int threads)
    : store_(store),
      depth_(depth),
      top_(top),
      attribute_count_(attribute_count),
      keeps_all_(keeps_all),
      threads_(threads),
      slots_(static_cast<std::size_t>(store->slab_count())),
      sparse_(static_cast<std::size_t>(store->slab_count())) {}

const SampleSlab* Slabs::samples(int s) const {
  return s < 0 || s >= count() ? nullptr : &slots_[static_cast<std::size_t>(s)].samples;
}

const FluxTree* Slabs::tree(int s) const {
  return s < 0 || s >= count() ? nullptr : &slots_[static_cast<std::size_t>(s)].tree;
}

void Slabs::set_values(int s, FluxTree tree) {
  Slot& slot = slots_[static_cast<std::size_t>(s)];
  slot.tree = std::move(tree);
  slot.splits = SplitCells();
  slot.stage = SlabStage::kValues;
}

void Slabs::advance_to(int begin, int end, SlabStage stage) {
  if (stage == SlabStage::kNone) return;
  begin = std::max(begin, 0);
  end = std::min(end, count());
  const auto is_there = [&](int s) { return slots_[static_cast<std::size_t>(s)].stage >= stage; };
  while (begin < end && is_there(begin)) ++begin;
  while (begin < end && is_there(end - 1)) --end;
  if (begin == end) return;
  // Whether the surface crosses a cell depends on neighboring slabs, and so do patches at the
  // sides.
  if (stage == SlabStage::kCrossedCells) advance_to(begin - 1, end + 1, SlabStage::kLevels);
  if (stage == SlabStage::kCoefficients) advance_to(begin - 1, end + 1, SlabStage::kLeaves);
  if (stage == SlabStage::kSolved) advance_to(begin - 1, end + 1, SlabStage::kValues);
  advance_to(begin, end, static_cast<SlabStage>(static_cast<int>(stage) - 1));
  parallel_for(end - begin, Run(threads_), [&](std::int64_t i) {
    const int s = begin + static_cast<int>(i);
    if (!is_there(s)) advance(s, stage);
  });
  if (!keeps_all_) dropped_ = std::min(dropped_, begin);
  for (int s = std::max(begin - 1, 0); s < std::min(end + 1, count()); ++s) drop_used(s, stage);
}

void Slabs::drop_below(int end, bool for_good) {
  if (keeps_all_ && !for_good) return;
  for (; dropped_ < std::min(end, count()); ++dropped_) {
    slots_[static_cast<std::size_t>(dropped_)] = Slot();
  }
}

void Slabs::advance(int s, SlabStage stage) {
  Slot& slot = slots_[static_cast<std::size_t>(s)];
  switch (stage) {
    case SlabStage::kNone:
      break;
    case SlabStage::kLevels:
      slot.samples = make_sample_slab(keeps_all_ ? store_->take(s) : store_->slab(s), depth_, top_,
                                      attribute_count_);
      break;
    case SlabStage::kCrossedCells:
      find_crossed_cells(samples(s - 1), samples(s + 1), mean_weight, &slot.samples);
      break;
    case SlabStage::kLeaves:
      find_leaves_of(s);
      break;
    case SlabStage::kCoefficients:
      analyze(s);
      break;
    case SlabStage::kValues:
      synthesize_slab(s);
      break;
    case SlabStage::kSolved:
      solve(s);
      break;
  }
  slot.stage = stage;
  ++steps_;
}

void Slabs::find_leaves_of(int s) {
  SampleSlab& slab = slots_[static_cast<std::size_t>(s)].samples;
  const auto first = whole.at(top_).leaf.begin() +
                     static_cast<std::ptrdiff_t>(offsets[static_cast<std::size_t>(s)]);
  slab.at(top_).leaf.assign(first, first + static_cast<std::ptrdiff_t>(slab.at(top_).size()));
  find_leaves({mean_weight, least_leaf}, depth_, &slab);
  slots_[static_cast<std::size_t>(s)].splits = split_around_leaves(slab);
  for (int k = top_; is_sparse(k); ++k) {
    std::vector<SupportCell>& cells =
        sparse_[static_cast<std::size_t>(s)][static_cast<std::size_t>(k - top_)];
    cells.clear();
    add_support(slab, k, {0, 1 << k}, depth_, mean_weight, &cells);
  }
}

void Slabs::analyze(int s) {
  Slot& slot = slots_[static_cast<std::size_t>(s)];
  PooledFlux pooled(static_cast<std::size_t>(depth_) + 1);
  slot.left_out = weight_of_outliers(slot.samples.at(depth_));
  std::vector<const SplitCells*> all_splits;
  for (int t = std::max(s - 1, 0); t < std::min(s + 2, count()); ++t) {
    all_splits.push_back(&slots_[static_cast<std::size_t>(t)].splits);
  }
  const SplitCells splits = splits_in_slab(all_splits, s, top_, depth_);
  for (int k = top_; k <= depth_; ++k) {
    // A patch per leaf, about as many extrapolated ones, and the band's cells.
    const std::vector<std::uint8_t>& is_leaf = slot.samples.at(k).is_leaf;
    const auto leaves = std::count(is_leaf.begin(), is_leaf.end(), std::uint8_t{1});
    pooled[static_cast<std::size_t>(k)].reserve(2 * static_cast<std::size_t>(leaves) +
                                                (k > top_ ? splits.at(k - 1).size() : 0));
    const auto level_of = [&](int t) {
      const SampleSlab* slab = samples(t);
      return slab == nullptr ? nullptr : &slab->at(k);
    };
    const SampleLevel* coarser = k > top_ ? &samples(s)->at(k - 1) : nullptr;
    add_patches({level_of(s - 1), level_of(s), level_of(s + 1), coarser}, k, s << (k - top_),
                (s + 1) << (k - top_), splits, &pooled);
  }
  add_band(splits, s, top_, &pooled);
  slot.tree = analyze_flux(std::move(pooled), top_, depth_);
}

void Slabs::synthesize_slab(int s) {
  FluxTree& tree = slots_[static_cast<std::size_t>(s)].tree;
  std::vector<float> values;
  for (const CellFlux& cell : tree.tops) {
    float value = coarse.root;
    if (top_ > 0) {
      const NodeLevel& last = coarse.tree.levels.back();
      const auto it = std::lower_bound(last.places.begin(), last.places.end(), cell.place >> 3U);
      value =
          last.blocks.blocks[static_cast<std::size_t>(it - last.places.begin())][cell.place & 7U];
    }
    values.push_back(value);
  }
  synthesize_part(values, &tree);
}

// Frees the inputs of a stage once no adjacent slab needs them.
void Slabs::drop_used(int s, SlabStage stage) {
  for (int t = std::max({s - 1, dropped_, 0}); t < std::min(s + 2, count()); ++t) {
    if (slots_[static_cast<std::size_t>(t)].stage < stage) return;
  }
  Slot& slot = slots_[static_cast<std::size_t>(s)];
  if (stage == SlabStage::kCoefficients) slot.splits = SplitCells();
  if (stage != SlabStage::kSolved) return;
  for (NodeLevel& level : slot.tree.levels) {
    if (level.solved.empty()) continue;
    level.blocks.blocks = std::move(level.solved);
    level.solved = {};
    level.fluxes = {};
    level.has_flux = {};
    level.first_flux = {};
  }
}

void Slabs::solve(int s) {
  if (target == 0.0F) return;
  BlockSources sources;
  CellTree window =
      assemble_unsolved(coarse, {tree(s - 1), tree(s), tree(s + 1)}, s, depth_, &sources);
  solve_screened(sources, top_, target, &window);
  for (int k = top_; k < depth_; ++k) {
    const auto level = static_cast<std::size_t>(k);
    NodeLevel& own =
        slots_[static_cast<std::size_t>(s)].tree.levels[static_cast<std::size_t>(k - top_)];
    own.solved.resize(own.blocks.size());
    for (std::size_t b = 0; b < sources[level].size(); ++b) {
      const BlockSource& source = sources[level][b];
      if (source.level == &own) own.solved[source.block] = window.levels[level].blocks[b];
    }
  }
}

}  // namespace prefilter
