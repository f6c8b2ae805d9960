// SPDX-License-Identifier: GPL-3.0-or-later

// Stacks of shapes as they are given; overlaps and multiple windings are resolved cell by cell.
#pragma once

#include <cstdint>
#include <deque>
#include <span>
#include <vector>

#include "prefilter/shapes/paint.h"
#include "prefilter/shapes/raster/edge_list.h"
#include "prefilter/shapes/rasterize.h"

namespace prefilter {

struct StackLayer {
  EdgeList edges;
  FillRule fill_rule = FillRule::kNonzero;
  const Paint* paint = nullptr;  // of any kind but kLinearStops
  bool winds_once = false;       // known to wind once
  /// Draws nothing: its outline marks where the color of the previous layer has a kink or a jump.
  bool is_cutter = false;
};

struct LayerStack {
  std::vector<StackLayer> layers;  // from the lowest
  bool is_constant = true;         // whether all colors are constant
  /// Whether layers are composited by their coverage of pixels (CompositedRows), so that only
  /// marked pixels need a more exact method.
  bool is_composited = false;
  /// Storage for outlines and paints that are not part of the input.
  std::deque<Outline> outlines;
  std::deque<Paint> paints;
};

/// One shape of a stack.
struct StackShape {
  const Outline* outline = nullptr;
  FillRule fill_rule = FillRule::kNonzero;
  const Paint* paint = nullptr;
  bool winds_once = false;
};

/// Stacks shapes from the lowest. Their outlines and paints must outlive the stack.
LayerStack make_stack(std::span<const StackShape> shapes);
LayerStack make_stack(std::span<const Shape> shapes);

}  // namespace prefilter
