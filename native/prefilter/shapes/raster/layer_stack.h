// SPDX-License-Identifier: GPL-3.0-or-later

// Shapes over each other as they are: what overlaps, and winds more than once, is found cell by
// cell.
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
  bool winds_once = false;       // whether that is known
  /// Shows nothing: its outline is where the color of the layer before has a kink or a jump.
  bool is_cutter = false;
};

struct LayerStack {
  std::vector<StackLayer> layers;  // from the lowest
  bool is_constant = true;         // whether all colors are
  /// Whether layers are put over each other by what they cover of pixels, as CompositedRows does,
  /// so that only some pixels are looked at more closely.
  bool is_composited = false;
  /// What layers are of that are no shapes.
  std::deque<Outline> outlines;
  std::deque<Paint> paints;
};

/// What a stack is made of.
struct StackShape {
  const Outline* outline = nullptr;
  FillRule fill_rule = FillRule::kNonzero;
  const Paint* paint = nullptr;
  bool winds_once = false;
};

/// Shapes over each other, from the lowest, of which the outlines and paints must outlive it.
LayerStack stack_of(std::span<const StackShape> shapes);
LayerStack stack_of(std::span<const Shape> shapes);

}  // namespace prefilter
