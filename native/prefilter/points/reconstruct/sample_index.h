// SPDX-License-Identifier: GPL-3.0-or-later

// Finds the samples near a point.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/points/reconstruct/sample_slab.h"

namespace prefilter {

/// The cells of one depth between two heights, indexed by rows.
class SampleIndex {
 public:
  SampleIndex(int depth, int low, int high) : side_(1 << depth), low_(low), high_(high) {
    rows_.reserve(static_cast<std::size_t>(side_) * static_cast<std::size_t>(high - low) + 1);
  }

  /// Adds cells in order from bottom to top; cells at other heights are ignored.
  void add(const SampleLevel& level) {
    for (std::size_t i = 0; i < level.size(); ++i) {
      const SampleCell& cell = level.samples.cells[i];
      const CellPosition at = cell_position(cell.key);
      if (at[2] < low_ || at[2] >= high_) continue;
      begin_rows(row(at[1], at[2]) + 1);
      cells_.push_back({&level, static_cast<std::uint32_t>(i), at[0]});
    }
  }
  /// Call once, after the last `add`.
  void finish() {
    begin_rows(static_cast<std::size_t>(side_) * static_cast<std::size_t>(high_ - low_) + 1);
  }

  /// Calls visit(cells, index, corner) for the cells with samples within `reach` cells, along each
  /// axis, of the cell that contains a point; `corner` is the cell's low corner. Points and corners
  /// are in cells from the root's corner.
  template <typename Visit>
  void for_near(const Vector3& point, int reach, const Visit& visit) const {
    CellPosition at;
    for (std::size_t a = 0; a < 3; ++a) {
      at[a] = static_cast<std::int32_t>(
          std::clamp(std::floor(point[a]), 0.0, static_cast<double>(side_ - 1)));
    }
    for (int z = std::max(at[2] - reach, low_); z <= std::min(at[2] + reach, high_ - 1); ++z) {
      for (int y = std::max(at[1] - reach, 0); y <= std::min(at[1] + reach, side_ - 1); ++y) {
        const std::size_t r = row(y, z);
        auto entry = cells_.begin() + rows_[r];
        const auto end = cells_.begin() + rows_[r + 1];
        if (end - entry > 8) {
          entry = std::lower_bound(entry, end, at[0] - reach,
                                   [](const Entry& e, std::int32_t x) { return e.x < x; });
        }
        for (; entry != end && entry->x <= at[0] + reach; ++entry) {
          if (entry->x < at[0] - reach) continue;
          visit(entry->level->samples, entry->index,
                Vector3{static_cast<double>(entry->x), static_cast<double>(y),
                        static_cast<double>(z)});
        }
      }
    }
  }

  /// Calls visit(cell) for all cells.
  template <typename Visit>
  void for_all(const Visit& visit) const {
    for (const Entry& entry : cells_) visit(entry.level->samples.cells[entry.index]);
  }

 private:
  struct Entry {
    const SampleLevel* level;
    std::uint32_t index;
    std::int32_t x;
  };

  std::size_t row(int y, int z) const {
    return static_cast<std::size_t>(z - low_) * static_cast<std::size_t>(side_) +
           static_cast<std::size_t>(y);
  }
  // Completes the row offsets below `count`: these rows end at the present number of cells.
  void begin_rows(std::size_t count) {
    while (rows_.size() < count) rows_.push_back(static_cast<std::uint32_t>(cells_.size()));
  }

  int side_;
  int low_;
  int high_;
  std::vector<Entry> cells_;
  std::vector<std::uint32_t> rows_;  // offset of each row's first cell
};

}  // namespace prefilter
