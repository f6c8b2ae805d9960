// SPDX-License-Identifier: GPL-3.0-or-later

// Grades the octree around the samples' leaves: it is fine there, and coarsens gradually with the
// distance. All neighbors of a leaf, and of a split cell, exist.
//
// Therefore the surface never passes between a cell and one more than twice as large, except where
// it fills holes; there, cells grow with the distance from the hole's border.
#pragma once

#include <cstdint>
#include <vector>

#include "prefilter/points/reconstruct/flux_tree.h"
#include "prefilter/points/reconstruct/sample_slab.h"

namespace prefilter {

/// All cells down to this depth exist, independent of the samples.
inline constexpr int kFullDepth = 5;

/// The set of split cells.
class SplitCells {
 public:
  SplitCells() = default;
  /// For split cells of depths below `depth`.
  explicit SplitCells(int depth) : places_(static_cast<std::size_t>(depth)) {}

  int depth() const { return static_cast<int>(places_.size()); }
  /// Morton indices of the split cells of depth k, sorted. Cells above kFullDepth may be missing.
  std::vector<std::uint64_t>& at(int k) { return places_[static_cast<std::size_t>(k)]; }
  const std::vector<std::uint64_t>& at(int k) const { return places_[static_cast<std::size_t>(k)]; }
  bool is_split(int k, std::uint64_t place) const;

 private:
  std::vector<std::vector<std::uint64_t>> places_;
};

/// Split cells that the leaves of a slab's samples require, in the slab and around it, from the
/// slab's first depth down.
SplitCells split_around_leaves(const SampleSlab& slab);

/// Unites the given sets, restricted to slab `s`; null stands for an empty set.
SplitCells splits_in_slab(const std::vector<const SplitCells*>& splits, int s, int top, int depth);

/// Split cells that the levels above the slabs require; `tops` are the slabs' first cells.
SplitCells coarse_splits(const SampleSlab& whole, const std::vector<CellFlux>& tops);

/// Adds cells without samples, so that all cells of `splits` in slab `s` have octants.
void add_band(const SplitCells& splits, int s, int top, PooledFlux* pooled);

/// The same for the levels above the slabs.
void add_coarse_band(const SplitCells& splits, PooledFlux* flux);

}  // namespace prefilter
