// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/reconstruct/surface_level.h"

#include <cstddef>
#include <vector>

#include "prefilter/reconstruct/assemble.h"
#include "prefilter/reconstruct/slab_walk.h"
#include "prefilter/wavelet/smooth.h"

namespace prefilter {
namespace {

double mean_at_samples(float sign, const ReconstructOptions& options, const Progress& progress,
                       Slabs* slabs) {
  const int depth = slabs->depth();
  const auto cells_of = [&](int s) -> const std::vector<SampleCell>& {
    return slabs->samples(s)->at(depth).samples.cells;
  };
  std::vector<double> sums(static_cast<std::size_t>(slabs->count()));
  double sum = 0.0;
  double weight = 0.0;
  const auto add_up = [&](int s) {
    const CellTree tree = tree_around(*slabs, s, sign, options.smooth);
    for (const SampleCell& cell : cells_of(s)) {
      sums[static_cast<std::size_t>(s)] +=
          static_cast<double>(cell.weight) *
          static_cast<double>(leaf_value(tree, depth, cell_position(cell.key)));
    }
  };
  const auto join = [&](int s) {
    sum += sums[static_cast<std::size_t>(s)];
    for (const SampleCell& cell : cells_of(s)) weight += static_cast<double>(cell.weight);
  };
  for_slabs({SlabStage::kValues, 1}, progress, options.threads, slabs, add_up, join);
  return sum / weight;
}

}  // namespace

SurfaceLevel find_surface_level(const ReconstructOptions& options, bool is_flipped,
                                const Progress& progress, Slabs* slabs) {
  const float sign = is_flipped ? -1.0F : 1.0F;
  if (options.isovalue == Isovalue::kHalf) return {sign, 0.5F};
  if (options.isovalue == Isovalue::kGiven) {
    return {sign, static_cast<float>(options.given_isovalue)};
  }
  return level_of_mean(mean_at_samples(sign, options, progress, slabs), is_flipped,
                       options.are_sides_known);
}

SurfaceLevel level_of_mean(double mean, bool is_flipped, bool are_sides_known) {
  constexpr double kLeastOfClosed = 0.2;
  const float sign = is_flipped ? -1.0F : 1.0F;
  if (are_sides_known || mean < kLeastOfClosed) return {sign, static_cast<float>(mean)};
  return {sign * static_cast<float>(0.5 / mean), 0.5F};
}

CellTree tree_around(const Slabs& slabs, int s, float scale, bool is_smooth) {
  CellTree tree = assemble(slabs.coarse, {slabs.tree(s - 1), slabs.tree(s), slabs.tree(s + 1)}, s,
                           slabs.depth(), scale);
  if (is_smooth) smooth_leaves(&tree);
  return tree;
}

float leaf_value(const CellTree& tree, int depth, const CellPosition& at) {
  std::size_t block = 0;
  for (int k = 0;; ++k) {
    const int shift = depth - k - 1;
    const int o =
        ((at[0] >> shift) & 1) | ((at[1] >> shift) & 1) << 1 | ((at[2] >> shift) & 1) << 2;
    const TreeLevel& level = tree.levels[static_cast<std::size_t>(k)];
    if (!level.is_split(block, o)) return level.blocks[block][static_cast<std::size_t>(o)];
    block = level.child(block, o);
  }
}

}  // namespace prefilter
