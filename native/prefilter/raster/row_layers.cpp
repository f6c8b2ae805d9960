// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/raster/row_layers.h"

#include <algorithm>

#include "prefilter/outline/fill_rule.h"

namespace prefilter {

void RowLayers::begin_row() {
  for (const std::uint32_t layer : touched_) {
    base_[layer] = 0;
    full_.erase(layer);
  }
  touched_.clear();
  layers_.clear();
  steps_.clear();
}

void RowLayers::add_layer(std::span<const SideStep> steps, std::span<const StackArc> arcs) {
  const std::uint32_t layer = steps.empty() ? arcs.front().layer : steps.front().layer;
  layers_.push_back({layer, stack_.layers[layer].fill_rule, base_[layer], steps, arcs});
  full_.erase(layer);
  touched_.push_back(layer);
}

void RowLayers::enter(std::span<const StackArc> arcs) {
  layers_.clear();
  std::size_t step = 0;
  std::size_t arc = 0;
  while (step < steps_.size() || arc < arcs.size()) {
    const bool has_step =
        step < steps_.size() && (arc == arcs.size() || steps_[step].layer >= arcs[arc].layer);
    const std::uint32_t layer = has_step ? steps_[step].layer : arcs[arc].layer;
    const std::size_t first_step = step;
    const std::size_t first_arc = arc;
    while (step < steps_.size() && steps_[step].layer == layer) ++step;
    while (arc < arcs.size() && arcs[arc].layer == layer) ++arc;
    add_layer(std::span(steps_).subspan(first_step, step - first_step),
              arcs.subspan(first_arc, arc - first_arc));
  }
}

void RowLayers::leave(const CellLayer& layer) {
  std::int32_t& base = base_[layer.layer];
  own_.assign(layer.steps.begin(), layer.steps.end());
  for (const StackArc& arc : layer.arcs) {
    own_.push_back({layer.layer, arc.low.y, arc.winding});
    own_.push_back({layer.layer, arc.high.y, -arc.winding});
  }
  std::sort(own_.begin(), own_.end(),
            [](const SideStep& a, const SideStep& b) { return a.y < b.y; });
  // What is level leaves no arcs, so that steps may go on through many cells.
  bool has_steps = false;
  for (std::size_t i = 0; i < own_.size();) {
    SideStep sum = own_[i];
    while (++i < own_.size() && own_[i].y == sum.y) sum.winding += own_[i].winding;
    if (sum.winding == 0) continue;
    if (sum.y <= -0.5) {
      base += sum.winding;
    } else if (sum.y < 0.5) {
      next_steps_.push_back(sum);
      has_steps = true;
    }
  }
  if (!has_steps && is_filled(base, layer.fill_rule)) full_.insert(layer.layer);
}

bool RowLayers::leave() {
  next_steps_.clear();
  for (const CellLayer& layer : layers_) leave(layer);
  layers_.clear();
  std::swap(steps_, next_steps_);
  return !steps_.empty();
}

}  // namespace prefilter
