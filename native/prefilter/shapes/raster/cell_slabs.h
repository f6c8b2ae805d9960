// SPDX-License-Identifier: GPL-3.0-or-later

// Cuts a cell into slabs in which no arc ends and no two arcs cross.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "prefilter/shapes/raster/row_layers.h"

namespace prefilter {

/// The arcs that cross a cell, as parabolas, and the heights at which an arc ends or two arcs
/// cross. Within each slab between two heights the arcs have a fixed order from left to right.
class CellSlabs {
 public:
  struct Arc {
    Point2 low;
    Point2 high;
    double slope = 0.0;
    double bend = 0.0;
    double x = 0.0;  // at the middle of the slab
    std::uint32_t layer = 0;
    std::int32_t winding = 0;

    double x_at(double y) const { return low.x + (y - low.y) * (slope + bend * (y - high.y)); }
  };

  /// Calls use_slab(low, high) for each slab, from the lowest, with order() and left_side() set for
  /// it. Stops and returns false after `most_work` steps. At most 63 layers.
  template <typename UseSlab>
  bool visit(std::span<const CellLayer> layers, std::size_t most_work, const UseSlab& use_slab);

  /// The arcs of the slab, from left to right.
  std::span<const std::uint32_t> order() const { return order_; }
  const Arc& arc(std::uint32_t index) const { return arcs_[index]; }
  /// Bit mask of the layers present at the left side of the slab.
  std::uint64_t left_side() const { return left_side_; }
  /// The layers to the right of an arc, given those to its left. Arcs must be crossed in order.
  std::uint64_t cross(const Arc& arc, std::span<const CellLayer> layers, std::uint64_t present);
  /// Steps taken so far.
  std::size_t work() const { return work_; }

 private:
  // Slabs thinner than this fraction of a cell are skipped.
  static constexpr double kMinSlabHeight = 1e-12;

  void collect_arcs(std::span<const CellLayer> layers);
  void add_crossings();
  void add_crossings_of(const Arc& a, const Arc& b);
  void sort_heights();
  void begin_slab(std::span<const CellLayer> layers, double middle);

  std::vector<Arc> arcs_;
  std::vector<double> heights_;
  std::vector<std::uint32_t> order_;
  std::vector<std::int32_t> windings_;
  std::uint64_t left_side_ = 0;
  std::size_t work_ = 0;
};

template <typename UseSlab>
bool CellSlabs::visit(std::span<const CellLayer> layers, std::size_t most_work,
                      const UseSlab& use_slab) {
  windings_.resize(layers.size());
  collect_arcs(layers);
  work_ = arcs_.size() * arcs_.size() / 4;
  if (work_ > most_work) return false;
  add_crossings();
  sort_heights();
  double low = -0.5;
  for (const double height : heights_) {
    if (height - low <= kMinSlabHeight) continue;
    begin_slab(layers, 0.5 * (low + height));
    use_slab(low, height);
    low = height;
    if (work_ > most_work) return false;
  }
  return true;
}

}  // namespace prefilter
