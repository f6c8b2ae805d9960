// SPDX-License-Identifier: GPL-3.0-or-later

// What a cell shows on average of layers of constant colors, from the areas between arcs.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "prefilter/shapes/raster/cell_colors.h"
#include "prefilter/shapes/raster/cell_slabs.h"
#include "prefilter/shapes/raster/row_layers.h"

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
  std::size_t work() const { return slabs_.work(); }

 private:
  struct State {
    std::uint64_t present = 0;
    ChannelValues color{};
  };

  void add_slab(std::span<const CellLayer> layers, const CellColors& colors, double height);
  std::size_t state_of(std::uint64_t present, const CellColors& colors);

  CellSlabs slabs_;
  std::vector<State> states_;
  ChannelValues mean_{};
};

}  // namespace prefilter
