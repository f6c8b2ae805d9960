// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/raster/layer_stack.h"

#include <utility>

#include "prefilter/raster/gradient_strips.h"

namespace prefilter {
namespace {

void add_layer(const Outline& outline, FillRule rule, const Paint& paint, LayerStack* stack) {
  if (outline.empty()) return;
  stack->layers.push_back({{}, rule, &paint});
  stack->layers.back().edges.add(outline);
  stack->is_constant = stack->is_constant && paint.kind == Paint::Kind::kConstant;
}

}  // namespace

LayerStack stack_of(std::span<const Shape> shapes) {
  LayerStack stack;
  for (const Shape& shape : shapes) {
    if (shape.paint.kind != Paint::Kind::kLinearStops) {
      add_layer(shape.outline, shape.fill_rule, shape.paint, &stack);
      continue;
    }
    for (GradientStrip& strip : gradient_strips(shape.outline, shape.paint)) {
      stack.outlines.push_back(std::move(strip.outline));
      stack.paints.push_back(std::move(strip.paint));
      add_layer(stack.outlines.back(), shape.fill_rule, stack.paints.back(), &stack);
    }
  }
  return stack;
}

}  // namespace prefilter
