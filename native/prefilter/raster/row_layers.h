// SPDX-License-Identifier: GPL-3.0-or-later

// The layers of which outlines pass a cell, and what each winds around along its left side.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "prefilter/raster/layer_set.h"
#include "prefilter/raster/stack_arcs.h"

namespace prefilter {

/// From a height on, the winding number at the left side of a cell is higher by this.
struct SideStep {
  std::uint32_t layer = 0;
  double y = 0.0;  // from the cell's center
  std::int32_t winding = 0;
};

/// A layer in a cell.
struct CellLayer {
  std::uint32_t layer = 0;
  FillRule fill_rule = FillRule::kNonzero;
  std::int32_t base = 0;  // its winding number at the lower left corner
  std::span<const SideStep> steps;
  std::span<const StackArc> arcs;
};

/// Goes along a row of cells from the left.
class RowLayers {
 public:
  explicit RowLayers(const LayerStack& stack)
      : stack_(stack), base_(stack.layers.size(), 0), full_(stack.layers.size()) {}

  void begin_row();
  /// Comes to a cell, of which the arcs are by layers from the highest.
  void enter(std::span<const StackArc> arcs);
  /// Those of the cell, from the highest.
  std::span<const CellLayer> layers() const { return layers_; }
  /// Layers that fill all of the cell, and those behind it until there are arcs again. Not with
  /// them are the layers of the cell until it is left.
  const LayerSet& full() const { return full_; }
  /// Goes behind the cell. Returns whether some layer has steps there, so that the next cell has to
  /// be entered too.
  bool leave();

 private:
  void add_layer(std::span<const SideStep> steps, std::span<const StackArc> arcs);
  void leave(const CellLayer& layer);

  const LayerStack& stack_;
  std::vector<std::int32_t> base_;
  LayerSet full_;
  std::vector<std::uint32_t> touched_;
  std::vector<CellLayer> layers_;
  std::vector<SideStep> steps_;
  std::vector<SideStep> next_steps_;
  std::vector<SideStep> own_;
};

}  // namespace prefilter
