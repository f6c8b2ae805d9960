// SPDX-License-Identifier: GPL-3.0-or-later

// The data-dependent isovalue of section 4.3: the mean of the function over the samples.
#include "prefilter/points/reconstruct/surface_level.h"

#include <cstddef>
#include <vector>

#include "prefilter/points/reconstruct/assemble.h"
#include "prefilter/points/reconstruct/slab_walk.h"
#include "prefilter/points/reconstruct/tree_leaf.h"
#include "prefilter/wavelet/smooth.h"

namespace prefilter {
namespace {

MeanSample mean_at_samples(float sign, const ReconstructOptions& options, const Run& run,
                           Slabs* slabs) {
  const int depth = slabs->depth();
  const auto cells_of = [&](int s) -> const std::vector<SampleCell>& {
    return slabs->samples(s)->at(depth).samples.cells;
  };
  std::vector<double> sums(static_cast<std::size_t>(slabs->count()));
  MeanSample sum;
  double weight = 0.0;
  const auto add_up = [&](int s) {
    CellTree tree = tree_around(*slabs, s, kContourOctants, sign);
    if (options.smooth) smooth_leaves(&tree);
    for (const SampleCell& cell : cells_of(s)) {
      sums[static_cast<std::size_t>(s)] +=
          static_cast<double>(cell.weight) *
          static_cast<double>(leaf_value(tree, depth, cell_position(cell.key)));
    }
  };
  const auto join = [&](int s) {
    sum.value += sums[static_cast<std::size_t>(s)];
    for (const SampleCell& cell : cells_of(s)) {
      weight += static_cast<double>(cell.weight);
      for (std::size_t a = 0; a < 3; ++a) sum.normal[a] += static_cast<double>(cell.normal[a]);
    }
  };
  for_slabs({SlabStage::kSolved, 1}, run, slabs, add_up, join);
  return {sum.value / weight, (1.0 / weight) * sum.normal};
}

}  // namespace

SurfaceLevel find_surface_level(const ReconstructOptions& options, bool is_inward, const Run& run,
                                Slabs* slabs) {
  const bool is_flipped = is_inward && !options.are_sides_known;
  const bool may_be_room = is_inward && options.are_sides_known;
  MeanSample mean;
  const bool is_solved = slabs->target != 0.0F;
  // Smoothing removes most of shapes that are only a few cells wide.
  constexpr int kMinSolvedDepth = 4;
  const bool is_known = is_solved && slabs->depth() >= kMinSolvedDepth;
  if ((options.isovalue == Isovalue::kMean && !is_known) || may_be_room) {
    mean = mean_at_samples(is_flipped ? -1.0F : 1.0F, options, run, slabs);
  }
  // In a scanned room the normals point into the enclosed space, so the enclosed space counts as
  // inside; the outside is unbounded. The solve enforces one value at all samples, so only the
  // function before it distinguishes a room from a sheet.
  const double before = is_solved ? slabs->unsolved_mean : mean.value;
  const bool is_reversed = may_be_room && is_room({before, mean.normal});
  if (is_reversed) mean.value = -mean.value;
  const float sign = is_flipped || is_reversed ? -1.0F : 1.0F;
  SurfaceLevel level;
  if (options.isovalue == Isovalue::kMean && is_known) {
    level = {sign, sign * slabs->target};
  } else if (options.isovalue == Isovalue::kMean) {
    level = level_of_mean(mean.value, sign < 0.0F, options.are_sides_known);
  } else {
    level = {sign, options.isovalue == Isovalue::kHalf
                       ? 0.5F
                       : static_cast<float>(options.given_isovalue)};
  }
  level.is_reversed = is_reversed;
  return level;
}

bool is_room(const MeanSample& mean) {
  constexpr double kMaxRoomMean = -0.15;
  constexpr double kMinSheetNormal = 0.4;
  return mean.value < kMaxRoomMean && length(mean.normal) < kMinSheetNormal;
}

SurfaceLevel level_of_mean(double mean, bool is_flipped, bool are_sides_known) {
  constexpr double kMinClosedMean = 0.2;  // below it the level is shifted, not scaled
  const float sign = is_flipped ? -1.0F : 1.0F;
  if (are_sides_known || mean < kMinClosedMean) return {sign, static_cast<float>(mean)};
  return {sign * static_cast<float>(0.5 / mean), 0.5F};
}

CellTree tree_around(const Slabs& slabs, int s, int octants, float scale) {
  return assemble(slabs.coarse, {slabs.tree(s - 1), slabs.tree(s), slabs.tree(s + 1)}, s,
                  slabs.depth(), octants, scale);
}

float leaf_value(const CellTree& tree, int depth, const CellPosition& at) {
  return value_of(*cell_at(tree, depth, at), tree);
}

}  // namespace prefilter
