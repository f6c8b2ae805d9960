// SPDX-License-Identifier: GPL-3.0-or-later

// The levels of the tree that stay in memory (first pass of section 4.3.2): Equation 4.2 at the
// depths above the slabs.
#include "prefilter/points/reconstruct/coarse_tree.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "prefilter/geometry/spatial/morton.h"
#include "prefilter/points/reconstruct/leaf_band.h"
#include "prefilter/points/reconstruct/plane_patches.h"
#include "prefilter/points/reconstruct/slab_walk.h"
#include "prefilter/wavelet/root_mean.h"

namespace prefilter {

CoarseTree make_coarse_tree(PooledFlux flux, int top, int slab_count) {
  CoarseTree coarse;
  std::vector<CellFlux> tops = flux.back();
  std::sort(tops.begin(), tops.end(),
            [](const CellFlux& a, const CellFlux& b) { return a.place < b.place; });
  std::vector<std::uint32_t> next(static_cast<std::size_t>(slab_count));
  for (const CellFlux& cell : tops) {
    if (!cell.is_split) continue;
    const int slab = morton_cell(cell.place)[2];
    coarse.continuations.push_back({slab, next[static_cast<std::size_t>(slab)]++});
  }
  coarse.tree = analyze_flux(std::move(flux), 0, top);
  RootMean mean;
  if (!coarse.tree.tops.empty()) mean.add_inside(coarse.tree.tops.front().flux);
  coarse.root = static_cast<float>(mean.median());
  synthesize_part({coarse.root}, &coarse.tree);
  return coarse;
}

void solve_coarse_tree(float target, CoarseTree* coarse) {
  CellTree tree;
  tree.root = coarse->root;
  BlockSources sources;
  for (const NodeLevel& level : coarse->tree.levels) {
    tree.levels.push_back(level.blocks);
    sources.emplace_back();
    for (std::size_t b = 0; b < level.blocks.size(); ++b) sources.back().push_back({&level, b});
  }
  // Cells of the last level that are split continue in the slabs.
  if (!tree.levels.empty()) {
    std::fill(tree.levels.back().split.begin(), tree.levels.back().split.end(), std::uint8_t{0});
  }
  solve_screened(sources, 0, target, &tree);
  for (std::size_t k = 0; k < tree.levels.size(); ++k) {
    coarse->tree.levels[k].blocks.blocks = std::move(tree.levels[k].blocks);
  }
}

namespace {

// Adds the leaves above the slabs. Samples in leaves of depth `top` were added by the slabs.
void add_coarse_leaves(const SplitCells& splits, SampleSlab* whole, PooledFlux* flux) {
  find_split(whole);
  SampleLevel& last = whole->at(whole->depth());
  for (std::size_t i = 0; i < last.size(); ++i) {
    if (last.leaf[i] == whole->depth()) last.is_leaf[i] = 0;
  }
  for (int k = 0; k <= whole->depth(); ++k) {
    const SampleLevel* coarser = k > 0 ? &whole->at(k - 1) : nullptr;
    add_patches({nullptr, &whole->at(k), nullptr, coarser}, k, 0, 1 << k, splits, flux);
  }
}

}  // namespace

double build_coarse_tree(const Run& run, Slabs* slabs) {
  PooledFlux flux(static_cast<std::size_t>(slabs->top()) + 1);
  double left_out = 0.0;
  std::vector<std::uint8_t> is_split;
  const auto collect = [&](int s) {
    const std::vector<std::uint8_t>& first = slabs->samples(s)->at(slabs->top()).is_split;
    is_split.insert(is_split.end(), first.begin(), first.end());
    const std::vector<CellFlux>& tops = slabs->tree(s)->tops;
    flux.back().insert(flux.back().end(), tops.begin(), tops.end());
    left_out += slabs->left_out(s);
  };
  for_slabs(
      {SlabStage::kCoefficients}, run, slabs, [](int) {}, collect);
  slabs->whole.at(slabs->top()).is_split = std::move(is_split);
  const SplitCells splits = coarse_splits(slabs->whole, flux.back());
  add_coarse_leaves(splits, &slabs->whole, &flux);
  const bool has_surface = std::any_of(flux.begin(), flux.end(), [](const auto& cells) {
    return std::any_of(cells.begin(), cells.end(),
                       [](const CellFlux& cell) { return cell.sampled.area > 0.0F; });
  });
  add_coarse_band(splits, &flux);
  slabs->coarse = make_coarse_tree(std::move(flux), slabs->top(), slabs->count());
  slabs->coarse.has_surface = has_surface;
  return left_out;
}

}  // namespace prefilter
