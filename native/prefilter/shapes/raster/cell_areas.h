// SPDX-License-Identifier: GPL-3.0-or-later

// Mean color of a cell under layers of constant colors, from the areas between arcs.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "prefilter/shapes/raster/cell_colors.h"
#include "prefilter/shapes/raster/cell_slabs.h"
#include "prefilter/shapes/raster/row_layers.h"

namespace prefilter {

/// The counterpart of CellSweep for the box filter, which needs only areas: in each slab of a cell,
/// an area is the integral of a parabola.
class CellAreas {
 public:
  /// Computes the mean color of a cell minus the background. `layers` are the visible layers, at
  /// most 63. Returns false if that takes more than `most_work` steps.
  bool find(std::span<const CellLayer> layers, const CellColors& colors, std::size_t most_work);
  const ChannelValues& mean() const { return mean_; }
  /// Steps taken.
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
