// SPDX-License-Identifier: GPL-3.0-or-later

// What a cell shows on average of layers of constant colors, from the areas between arcs.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "prefilter/raster/cell_colors.h"
#include "prefilter/raster/row_layers.h"

namespace prefilter {

/// Goes up through a cell as CellSweep does, for the box filter, which asks for no more than areas:
/// between two heights at which an arc ends or two cross, each is an integral of a parabola.
class CellAreas {
 public:
  /// Sets the mean of what a cell shows less the background. `layers` are those that are seen, up
  /// to 63 of them. Returns false where that takes more than `most_work` steps.
  bool find(std::span<const CellLayer> layers, const CellColors& colors, std::size_t most_work);
  const ChannelValues& mean() const { return mean_; }
  /// How many steps that took.
  std::size_t work() const { return work_; }

 private:
  struct Arc {
    Point2 low;
    Point2 high;
    double slope = 0.0;
    double bend = 0.0;
    double x = 0.0;  // in the middle of the slab
    std::uint32_t layer = 0;
    std::int32_t winding = 0;

    double x_at(double y) const { return low.x + (y - low.y) * (slope + bend * (y - high.y)); }
  };
  struct State {
    std::uint64_t present = 0;
    ChannelValues color{};
  };

  void take_arcs(std::span<const CellLayer> layers);
  void add_crossings();
  void add_crossings_of(const Arc& a, const Arc& b);
  void add_slab(std::span<const CellLayer> layers, const CellColors& colors, double low,
                double high);
  std::uint64_t left_side(std::span<const CellLayer> layers, double y);
  std::size_t state_of(std::uint64_t present, const CellColors& colors);

  std::vector<Arc> arcs_;
  std::vector<double> heights_;
  std::vector<std::uint32_t> order_;
  std::vector<std::int32_t> windings_;
  std::vector<State> states_;
  ChannelValues mean_{};
  std::size_t work_ = 0;
};

}  // namespace prefilter
