// SPDX-License-Identifier: GPL-3.0-or-later

// Finds the cells to split so that all neighbors of given cells exist.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "prefilter/points/reconstruct/sample_cell.h"

namespace prefilter {

/// For given cells of one depth, collects the cells one depth up that contain them or a neighbor,
/// as Morton indices, limited to heights from `low` up to `high` there.
class SplitFinder {
 public:
  SplitFinder(int depth, int low, int high) : side_(1 << depth >> 1), low_(low), high_(high) {}

  void add(const CellPosition& cell);
  /// The collected indices, sorted and unique.
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
