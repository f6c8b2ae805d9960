// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/points/reconstruct/split_finder.h"

#include <algorithm>
#include <array>
#include <utility>

#include "prefilter/base/radix_sort.h"
#include "prefilter/geometry/spatial/morton.h"
#include "prefilter/wavelet/cell_tree.h"

namespace prefilter {

void SplitFinder::add(const CellPosition& cell) {
  std::array<std::array<std::int32_t, 2>, 3> parents;
  for (std::size_t a = 0; a < 3; ++a) {
    const std::int32_t p = cell[a] >> 1;
    parents[a] = {p, (cell[a] & 1) != 0 ? p + 1 : p - 1};
  }
  for (const std::int32_t z : parents[2]) {
    if (z < low_ || z >= high_) continue;
    for (const std::int32_t y : parents[1]) {
      if (y < 0 || y >= side_) continue;
      for (const std::int32_t x : parents[0]) {
        if (x >= 0 && x < side_) places_.push_back(morton_index({x, y, z}));
      }
    }
  }
  if (places_.size() > 2 * compact_size_ + (1U << 16U)) compact();
}

std::vector<std::uint64_t> SplitFinder::take() {
  compact();
  places_.shrink_to_fit();
  return std::move(places_);
}

void SplitFinder::compact() {
  std::vector<std::uint64_t> other;
  radix_sort(&places_, 0, 3 * kMaxTreeDepth, &other);
  places_.erase(std::unique(places_.begin(), places_.end()), places_.end());
  compact_size_ = places_.size();
}

}  // namespace prefilter
