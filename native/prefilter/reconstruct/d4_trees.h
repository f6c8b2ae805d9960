// SPDX-License-Identifier: GPL-3.0-or-later

// Which cells the function is told in, in the D4 basis: those that hold leaves as deep as their
// octants, or are next to such a leaf. The values of the trees are not set.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "prefilter/reconstruct/assemble.h"
#include "prefilter/reconstruct/d4_leaves.h"
#include "prefilter/reconstruct/flux_tree.h"
#include "prefilter/reconstruct/sample_cell.h"
#include "prefilter/reconstruct/slabs.h"

namespace prefilter {

/// Of some cells of a depth, the cells that are to be split: which hold these, or a neighbor, as
/// places along the Morton curve of the depth above. Only those from `low` up to `high` there.
class SplitFinder {
 public:
  SplitFinder(int depth, int low, int high) : side_(1 << depth >> 1), low_(low), high_(high) {}

  void add(const CellPosition& cell);
  /// Each once, in order.
  std::vector<std::uint64_t> take();

 private:
  void compact();

  std::int32_t side_;
  std::int32_t low_;
  std::int32_t high_;
  std::size_t compact_size_ = 0;
  std::vector<std::uint64_t> places_;
};

/// The tree of slab `s`.
FluxTree split_slab(const Slabs& slabs, std::span<const SlabLeaves> leaves, int s);

/// The tree above those of all slabs.
CoarseTree split_whole(const Slabs& slabs, const LeafFlags& flags, std::span<const FluxTree> trees);

}  // namespace prefilter
