// SPDX-License-Identifier: GPL-3.0-or-later

// Which cells of a tree are split, so that the cells around others are there.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "prefilter/points/reconstruct/sample_cell.h"

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

}  // namespace prefilter
