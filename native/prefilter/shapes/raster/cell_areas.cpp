// SPDX-License-Identifier: GPL-3.0-or-later

// Exact areas between parabolic arcs in the slabs of a cell.
#include "prefilter/shapes/raster/cell_areas.h"

namespace prefilter {

std::size_t CellAreas::state_of(std::uint64_t present, const CellColors& colors) {
  for (std::size_t i = states_.size(); i-- > 0;) {
    if (states_[i].present == present) return i;
  }
  states_.push_back({present, {}});
  colors.compose(present, &states_.back().color);
  return states_.size() - 1;
}

void CellAreas::add_slab(std::span<const CellLayer> layers, const CellColors& colors,
                         double height) {
  std::uint64_t present = slabs_.left_side();
  std::size_t state = state_of(present, colors);
  const auto add = [&](std::size_t of, double area) {
    const ChannelValues& color = states_[of].color;
    for (int c = 0; c < kMaxChannels; ++c) mean_[c] += area * color[c];
  };
  double left = -0.5;
  for (const std::uint32_t i : slabs_.order()) {
    const CellSlabs::Arc& arc = slabs_.arc(i);
    present = slabs_.cross(arc, layers, present);
    const std::size_t next = state_of(present, colors);
    if (next == state) continue;
    // A parabola's mean is its value at the middle plus a twelfth of its second difference.
    const double x = arc.x + arc.bend * height * height / 12.0;
    add(state, height * (x - left));
    left = x;
    state = next;
  }
  add(state, height * (0.5 - left));
}

bool CellAreas::find(std::span<const CellLayer> layers, const CellColors& colors,
                     std::size_t most_work) {
  mean_ = {};
  states_.clear();
  return slabs_.visit(layers, most_work,
                      [&](double low, double high) { add_slab(layers, colors, high - low); });
}

}  // namespace prefilter
