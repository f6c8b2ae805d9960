// SPDX-License-Identifier: GPL-3.0-or-later

// Shapes over each other as they are: what overlaps, and winds more than once, is found cell by
// cell.
#pragma once

#include <cstdint>
#include <deque>
#include <span>
#include <vector>

#include "prefilter/raster/edge_list.h"
#include "prefilter/raster/paint.h"
#include "prefilter/raster/rasterize.h"

namespace prefilter {

struct StackLayer {
  EdgeList edges;
  FillRule fill_rule = FillRule::kNonzero;
  const Paint* paint = nullptr;  // of any kind but kLinearStops
};

struct LayerStack {
  std::vector<StackLayer> layers;  // from the lowest
  bool is_constant = true;         // whether all colors are
  /// What layers are of that are no shapes.
  std::deque<Outline> outlines;
  std::deque<Paint> paints;
};

/// Shapes over each other, which must outlive it.
LayerStack stack_of(std::span<const Shape> shapes);
/// Some of them, by their numbers in rising order.
LayerStack stack_of(std::span<const Shape> shapes, std::span<const std::uint32_t> chosen);

}  // namespace prefilter
