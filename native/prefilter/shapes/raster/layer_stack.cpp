// SPDX-License-Identifier: GPL-3.0-or-later

// Linear gradients are split into strips; radial gradients get cutters.
#include "prefilter/shapes/raster/layer_stack.h"

#include <utility>
#include <vector>

#include "prefilter/shapes/raster/gradient_cutter.h"
#include "prefilter/shapes/raster/gradient_strips.h"

namespace prefilter {
namespace {

void add_layer(const Outline& outline, const StackShape& shape, const Paint& paint,
               LayerStack* stack) {
  if (outline.empty()) return;
  // For outlines that wind once both fill rules agree; even-odd is cheaper.
  const FillRule rule = shape.winds_once ? FillRule::kEvenOdd : shape.fill_rule;
  stack->layers.push_back({{}, rule, &paint, shape.winds_once, false});
  stack->layers.back().edges.add(outline);
  stack->is_constant = stack->is_constant && paint.kind == Paint::Kind::kConstant;
}

void add_cutter(const Outline& outline, const Paint& paint, LayerStack* stack) {
  Outline cutter = gradient_cutter(paint, control_box(outline));
  if (cutter.empty()) return;
  stack->outlines.push_back(std::move(cutter));
  stack->layers.push_back({{}, FillRule::kEvenOdd, &paint, false, true});
  stack->layers.back().edges.add(stack->outlines.back());
}

}  // namespace

LayerStack make_stack(std::span<const StackShape> shapes) {
  LayerStack stack;
  for (const StackShape& shape : shapes) {
    if (shape.paint->kind != Paint::Kind::kLinearStops) {
      add_layer(*shape.outline, shape, *shape.paint, &stack);
      // The cutter goes above its layer, which may hide the layers below.
      if (!shape.outline->empty()) add_cutter(*shape.outline, *shape.paint, &stack);
      continue;
    }
    for (GradientStrip& strip : gradient_strips(*shape.outline, *shape.paint)) {
      stack.outlines.push_back(std::move(strip.outline));
      stack.paints.push_back(std::move(strip.paint));
      add_layer(stack.outlines.back(), shape, stack.paints.back(), &stack);
    }
  }
  return stack;
}

LayerStack make_stack(std::span<const Shape> shapes) {
  std::vector<StackShape> of_stack;
  of_stack.reserve(shapes.size());
  for (const Shape& shape : shapes) {
    of_stack.push_back({&shape.outline, shape.fill_rule, &shape.paint, shape.winds_once});
  }
  return make_stack(of_stack);
}

}  // namespace prefilter
