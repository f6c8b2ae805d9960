// SPDX-License-Identifier: GPL-3.0-or-later

// A tree that is fine around the leaves of samples, and coarser step by step away from these: the
// cells around a leaf, and those around a cell that is split, are there.
//
// The surface then never passes between a cell and one more than twice as large, but where it fills
// holes, and there it is told in cells that grow with the distance from the hole's border.
#pragma once

#include <cstdint>
#include <vector>

#include "prefilter/points/reconstruct/flux_tree.h"
#include "prefilter/points/reconstruct/sample_slab.h"

namespace prefilter {

/// All cells of this depth are there, whatever the samples.
inline constexpr int kFullDepth = 5;

/// Cells that are split.
class SplitCells {
 public:
  SplitCells() = default;
  /// Of depths below `depth`.
  explicit SplitCells(int depth) : places_(static_cast<std::size_t>(depth)) {}

  int depth() const { return static_cast<int>(places_.size()); }
  /// Those of depth k as places along its Morton curve, in order. Cells less deep than the full
  /// depth may be missing.
  std::vector<std::uint64_t>& at(int k) { return places_[static_cast<std::size_t>(k)]; }
  const std::vector<std::uint64_t>& at(int k) const { return places_[static_cast<std::size_t>(k)]; }
  bool is_split(int k, std::uint64_t place) const;

 private:
  std::vector<std::vector<std::uint64_t>> places_;
};

/// Those that the leaves of a slab's samples ask for, in the slab and around it, of the depths from
/// the slab's first one.
SplitCells split_around_leaves(const SampleSlab& slab);

/// Of these, those in slab `s`, once each; null stands for none.
SplitCells splits_in_slab(const std::vector<const SplitCells*>& splits, int s, int top, int depth);

/// The same above the slabs, of which `tops` are the first cells.
SplitCells coarse_splits(const SampleSlab& whole, const std::vector<CellFlux>& tops);

/// Adds cells without samples, so that the cells of slab `s` that are to be split are.
void add_band(const SplitCells& splits, int s, int top, PooledFlux* pooled);

/// The same above the slabs.
void add_coarse_band(const SplitCells& splits, PooledFlux* flux);

}  // namespace prefilter
