// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/raster/layer_stack.h"

#include <optional>
#include <utility>

#include "prefilter/outline/resolve_soon.h"
#include "prefilter/raster/gradient_strips.h"

namespace prefilter {
namespace {

void add_layer(const Outline& outline, FillRule rule, const Paint& paint, bool is_one_of_many,
               LayerStack* stack) {
  if (outline.empty()) return;
  // Of what winds once both rules say the same, and that of odd numbers takes less.
  std::optional<Outline> changed;
  if (is_one_of_many && rule == FillRule::kNonzero && resolve_soon(outline, rule, {}, &changed) &&
      !changed) {
    rule = FillRule::kEvenOdd;
  }
  stack->layers.push_back({{}, rule, &paint});
  stack->layers.back().edges.add(outline);
  stack->is_constant = stack->is_constant && paint.kind == Paint::Kind::kConstant;
}

void add_shape(const Shape& shape, bool is_one_of_many, LayerStack* stack) {
  if (shape.paint.kind != Paint::Kind::kLinearStops) {
    add_layer(shape.outline, shape.fill_rule, shape.paint, is_one_of_many, stack);
    return;
  }
  for (GradientStrip& strip : gradient_strips(shape.outline, shape.paint)) {
    stack->outlines.push_back(std::move(strip.outline));
    stack->paints.push_back(std::move(strip.paint));
    add_layer(stack->outlines.back(), shape.fill_rule, stack->paints.back(), is_one_of_many, stack);
  }
}

}  // namespace

LayerStack stack_of(std::span<const Shape> shapes) {
  LayerStack stack;
  for (const Shape& shape : shapes) add_shape(shape, shapes.size() > 1, &stack);
  return stack;
}

LayerStack stack_of(std::span<const Shape> shapes, std::span<const std::uint32_t> chosen) {
  LayerStack stack;
  for (const std::uint32_t i : chosen) add_shape(shapes[i], chosen.size() > 1, &stack);
  return stack;
}

}  // namespace prefilter
