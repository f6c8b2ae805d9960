// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/reconstruct/whole_samples.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "prefilter/reconstruct/slab_walk.h"

namespace prefilter {
namespace {

void append(const SampleCells& more, SampleCells* all) {
  all->cells.insert(all->cells.end(), more.cells.begin(), more.cells.end());
  all->attributes.insert(all->attributes.end(), more.attributes.begin(), more.attributes.end());
}

}  // namespace

int find_whole(std::size_t attribute_count, const Progress& progress, int threads, Slabs* slabs) {
  SampleCells tops;
  std::size_t most = 0;
  int largest = 0;
  const auto collect = [&](int s) {
    const SampleSlab& slab = *slabs->samples(s);
    slabs->offsets.push_back(tops.size());
    append(slab.at(slabs->top()).samples, &tops);
    if (slab.at(slabs->depth()).size() > most) {
      most = slab.at(slabs->depth()).size();
      largest = s;
    }
  };
  for_slabs(
      {SlabStage::kMet}, progress, threads, slabs, [](int) {}, collect);
  slabs->whole = make_sample_slab(std::move(tops), slabs->top(), 0, attribute_count);
  find_met_cells(nullptr, nullptr, &slabs->whole);
  slabs->whole.at(0).leaf.assign(slabs->whole.at(0).size(), 0);
  const std::vector<SampleCell>& root = slabs->whole.at(0).samples.cells;
  const double all = root.empty() ? 0.0 : static_cast<double>(root.front().weight);
  find_leaves({slabs->mean_weight, all}, slabs->depth(), &slabs->whole);
  return largest;
}

}  // namespace prefilter
