// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/points/reconstruct/whole_samples.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "prefilter/points/reconstruct/slab_walk.h"

namespace prefilter {
namespace {

constexpr int kOutlierDepths = 2;  // outliers have leaves this far above the median

void append(const SampleCells& more, SampleCells* all) {
  all->cells.insert(all->cells.end(), more.cells.begin(), more.cells.end());
  all->attributes.insert(all->attributes.end(), more.attributes.begin(), more.attributes.end());
}

}  // namespace

int compute_whole_samples(std::size_t attribute_count, const Run& run, Slabs* slabs) {
  SampleCells tops;
  std::vector<double> weights(static_cast<std::size_t>(slabs->depth()) + 1);
  std::size_t most = 0;
  int largest = 0;
  const auto collect = [&](int s) {
    const SampleSlab& slab = *slabs->samples(s);
    slabs->offsets.push_back(tops.size());
    append(slab.at(slabs->top()).samples, &tops);
    weigh_leaves(slab, &weights);
    if (slab.at(slabs->depth()).size() > most) {
      most = slab.at(slabs->depth()).size();
      largest = s;
    }
  };
  for_slabs(
      {SlabStage::kCrossedCells}, run, slabs, [](int) {}, collect);
  slabs->whole = make_sample_slab(std::move(tops), slabs->top(), 0, attribute_count);
  find_crossed_cells(nullptr, nullptr, slabs->mean_weight, &slabs->whole);
  slabs->whole.at(0).leaf.assign(slabs->whole.at(0).size(), 0);
  slabs->least_leaf = least_leaf_depth(weights);
  find_leaves({slabs->mean_weight, slabs->least_leaf}, slabs->depth(), &slabs->whole);
  return largest;
}

void weigh_leaves(const SampleSlab& slab, std::vector<double>* weights) {
  std::vector<std::int8_t> leaf(slab.at(slab.top).size(), static_cast<std::int8_t>(slab.top));
  for (int k = slab.top + 1; k <= slab.depth(); ++k) {
    const SampleLevel& level = slab.at(k);
    std::vector<std::int8_t> next(level.size());
    for (std::size_t i = 0; i < level.size(); ++i) {
      next[i] = level.is_crossed(i) ? static_cast<std::int8_t>(k) : leaf[level.parents[i]];
    }
    leaf = std::move(next);
  }
  const std::vector<SampleCell>& finest = slab.at(slab.depth()).samples.cells;
  for (std::size_t i = 0; i < finest.size(); ++i) {
    (*weights)[static_cast<std::size_t>(leaf[i])] += static_cast<double>(finest[i].weight);
  }
}

int least_leaf_depth(const std::vector<double>& weights) {
  const int depth = static_cast<int>(weights.size()) - 1;
  double all = 0.0;
  for (const double weight : weights) all += weight;
  int median = 0;
  for (double sum = weights[0]; sum < all / 2.0 && median < depth;) {
    sum += weights[static_cast<std::size_t>(++median)];
  }
  return std::max(0, median - kOutlierDepths + 1);
}

}  // namespace prefilter
