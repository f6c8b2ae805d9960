// SPDX-License-Identifier: GPL-3.0-or-later

// A sweep over the heights of all ends and crossings, which are roots of quadratic polynomials.
#include "prefilter/shapes/raster/cell_slabs.h"

#include <algorithm>
#include <cmath>

#include "prefilter/shapes/outline/fill_rule.h"

namespace prefilter {
namespace {

// Insertion sort, for few values that are almost sorted.
template <typename T, typename Less>
void insertion_sort(std::vector<T>* values, const Less& is_less) {
  for (std::size_t i = 1; i < values->size(); ++i) {
    const T value = (*values)[i];
    std::size_t place = i;
    for (; place > 0 && is_less(value, (*values)[place - 1]); --place) {
      (*values)[place] = (*values)[place - 1];
    }
    (*values)[place] = value;
  }
}

}  // namespace

void CellSlabs::collect_arcs(std::span<const CellLayer> layers) {
  arcs_.clear();
  heights_.assign({-0.5, 0.5});
  for (std::size_t i = 0; i < layers.size(); ++i) {
    for (const SideStep& step : layers[i].steps) heights_.push_back(step.y);
    for (const StackArc& arc : layers[i].arcs) {
      const Point2 way = arc.high - arc.low;
      arcs_.push_back({arc.low, arc.high, way.x / way.y, arc.bend, 0.0,
                       static_cast<std::uint32_t>(i), arc.winding});
      heights_.push_back(arc.low.y);
      heights_.push_back(arc.high.y);
    }
  }
}

// Appends the heights at which two parabolas cross.
void CellSlabs::add_crossings_of(const Arc& a, const Arc& b) {
  const double low = std::max(a.low.y, b.low.y);
  const double high = std::min(a.high.y, b.high.y);
  const double height = high - low;
  if (height <= kMinSlabHeight) return;
  if (std::max(a.low.x, a.high.x) < std::min(b.low.x, b.high.x) ||
      std::max(b.low.x, b.high.x) < std::min(a.low.x, a.high.x)) {
    return;
  }
  const double at_low = a.x_at(low) - b.x_at(low);
  const double at_high = a.x_at(high) - b.x_at(high);
  const double square = a.bend - b.bend;
  const double linear = (at_high - at_low) / height - square * height;
  const auto add = [&](double up) {
    if (up > 0.0 && up < height) heights_.push_back(low + up);
  };
  if (square == 0.0) {
    if ((at_low < 0.0) != (at_high < 0.0)) add(-at_low / linear);
    return;
  }
  const double discriminant = linear * linear - 4.0 * square * at_low;
  if (discriminant <= 0.0) return;
  const double q = -0.5 * (linear + std::copysign(std::sqrt(discriminant), linear));
  add(q / square);
  if (q != 0.0) add(at_low / q);
}

void CellSlabs::add_crossings() {
  for (std::size_t i = 0; i < arcs_.size(); ++i) {
    for (std::size_t j = i + 1; j < arcs_.size(); ++j) add_crossings_of(arcs_[i], arcs_[j]);
  }
}

void CellSlabs::sort_heights() {
  constexpr std::size_t kMaxInsertionSort = 24;
  if (heights_.size() <= kMaxInsertionSort) {
    insertion_sort(&heights_, [](double a, double b) { return a < b; });
  } else {
    std::sort(heights_.begin(), heights_.end());
  }
}

void CellSlabs::begin_slab(std::span<const CellLayer> layers, double middle) {
  order_.clear();
  for (std::uint32_t i = 0; i < arcs_.size(); ++i) {
    Arc& arc = arcs_[i];
    if (!(arc.low.y < middle && middle < arc.high.y)) continue;
    arc.x = arc.x_at(middle);
    order_.push_back(i);
  }
  work_ += 1 + order_.size();
  insertion_sort(&order_,
                 [&](std::uint32_t a, std::uint32_t b) { return arcs_[a].x < arcs_[b].x; });
  left_side_ = 0;
  for (std::size_t i = 0; i < layers.size(); ++i) {
    windings_[i] = layers[i].base;
    for (const SideStep& step : layers[i].steps) {
      if (step.y <= middle) windings_[i] += step.winding;
    }
    if (is_filled(windings_[i], layers[i].fill_rule)) left_side_ |= std::uint64_t{1} << i;
  }
}

std::uint64_t CellSlabs::cross(const Arc& arc, std::span<const CellLayer> layers,
                               std::uint64_t present) {
  windings_[arc.layer] += arc.winding;
  const std::uint64_t bit = std::uint64_t{1} << arc.layer;
  present &= ~bit;
  if (is_filled(windings_[arc.layer], layers[arc.layer].fill_rule)) present |= bit;
  return present;
}

}  // namespace prefilter
