// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/reconstruct/coarse_tree.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "prefilter/reconstruct/slab_walk.h"
#include "prefilter/spatial/morton.h"
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
  synthesise_part({coarse.root}, &coarse.tree);
  return coarse;
}

double find_coarse_tree(const Progress& progress, int threads, Slabs* slabs) {
  PooledFlux flux(static_cast<std::size_t>(slabs->top()) + 1);
  double left_out = 0.0;
  const auto collect = [&](int s) {
    const PooledFlux& pooled = slabs->coarse_flux(s);
    for (std::size_t k = 0; k < pooled.size(); ++k) {
      flux[k].insert(flux[k].end(), pooled[k].begin(), pooled[k].end());
    }
    const std::vector<CellFlux>& tops = slabs->tree(s)->tops;
    flux.back().insert(flux.back().end(), tops.begin(), tops.end());
    left_out += slabs->left_out(s);
  };
  for_slabs(
      {SlabStage::kCoefficients}, progress, threads, slabs, [](int) {}, collect);
  slabs->coarse = make_coarse_tree(std::move(flux), slabs->top(), slabs->count());
  return left_out;
}

}  // namespace prefilter
