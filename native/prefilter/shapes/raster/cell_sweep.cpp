// SPDX-License-Identifier: GPL-3.0-or-later

// A plane sweep in one cell. Crossings of lines are exact; crossings of curves are found by
// comparing both along y.
#include "prefilter/shapes/raster/cell_sweep.h"

#include <algorithm>
#include <cmath>

#include "prefilter/shapes/outline/fill_rule.h"

namespace prefilter {
namespace {

// Arcs closer than this, in cells, count as overlapping: the area between them is invisible.
constexpr double kMinArcDistance = 1e-11;
// Slabs thinner than this, in cells, are skipped.
constexpr double kMinSweptSlabHeight = 1e-12;
// Largest number of bisections of an interval in which two curves approach each other.
constexpr int kMaxBisections = 10;

bool is_line(const StackArc& arc) { return arc.curve == StackArc::kLine; }

}  // namespace

double CellSweep::parameter_at(const StackArc& arc, double y) const {
  const StackCurve& curve = stack_arcs_.curve(arc);
  const MonotoneCurve& piece = stack_arcs_.piece(curve);
  const double t = crossing(piece, 1, center_.y + y, curve.t_begin);
  return std::min(t, curve.t_end);
}

double CellSweep::x_at(const StackArc& arc, double y) const {
  if (y <= arc.low.y) return arc.low.x;
  if (y >= arc.high.y) return arc.high.x;
  double x = 0.0;
  if (is_line(arc)) {
    const Point2 way = arc.high - arc.low;
    x = arc.low.x + (y - arc.low.y) * (way.x / way.y);
  } else {
    const StackCurve& curve = stack_arcs_.curve(arc);
    x = stack_arcs_.piece(curve).curve.at(parameter_at(arc, y)).x - center_.x;
  }
  return std::clamp(x, std::min(arc.low.x, arc.high.x), std::max(arc.low.x, arc.high.x));
}

double CellSweep::x_at(const SweptArc& swept, double y) const {
  const StackArc& arc = *swept.arc;
  return is_line(arc) ? arc.low.x + (y - arc.low.y) * swept.slope : x_at(arc, y);
}

void CellSweep::collect_arcs(std::span<const CellLayer> layers) {
  arcs_.clear();
  heights_.assign({-0.5, 0.5});
  for (std::size_t i = 0; i < layers.size(); ++i) {
    for (const SideStep& step : layers[i].steps) heights_.push_back(step.y);
    for (const StackArc& arc : layers[i].arcs) {
      const Point2 way = arc.high - arc.low;
      arcs_.push_back({&arc, static_cast<std::uint32_t>(i), kNoPart, way.x / way.y, 0.0});
      heights_.push_back(arc.low.y);
      heights_.push_back(arc.high.y);
    }
  }
}

double CellSweep::root_between(const SweptArc& a, const SweptArc& b, double low, double at_low,
                               double high, double at_high) const {
  const bool are_lines = is_line(*a.arc) && is_line(*b.arc);
  double y = low + (high - low) * (at_low / (at_low - at_high));
  if (are_lines) return y;
  // Regula falsi (Illinois variant), with a bisection every third step.
  for (int step = 0; step < 60 && high - low > kMinSweptSlabHeight; ++step) {
    y = step % 3 == 2 ? 0.5 * (low + high) : low + (high - low) * (at_low / (at_low - at_high));
    if (!(y > low && y < high)) y = 0.5 * (low + high);
    const double at = x_at(a, y) - x_at(b, y);
    if (std::fabs(at) <= kMinArcDistance) break;
    if ((at < 0.0) == (at_low < 0.0)) {
      low = y;
      at_low = at;
    } else {
      high = y;
      at_high = at;
    }
  }
  return y;
}

void CellSweep::add_roots(const SweptArc& a, const SweptArc& b, double low, double at_low,
                          double high, double at_high, int depth) {
  ++work_;
  if ((at_low < 0.0) != (at_high < 0.0)) {
    if (std::fabs(at_low) > kMinArcDistance || std::fabs(at_high) > kMinArcDistance) {
      heights_.push_back(root_between(a, b, low, at_low, high, at_high));
    }
    return;
  }
  if (depth == 0 || (is_line(*a.arc) && is_line(*b.arc))) return;
  // Curves may cross twice. The parabola through three points tells whether they come that close.
  const double middle = 0.5 * (low + high);
  const double at = x_at(a, middle) - x_at(b, middle);
  if ((at < 0.0) == (at_low < 0.0)) {
    const double nearest = std::min({std::fabs(at_low), std::fabs(at), std::fabs(at_high)});
    const double bend = std::fabs(at_low - 2.0 * at + at_high);
    if (nearest > bend || bend <= kMinArcDistance) return;
  }
  add_roots(a, b, low, at_low, middle, at, depth - 1);
  add_roots(a, b, middle, at, high, at_high, depth - 1);
}

void CellSweep::add_crossings_of(const SweptArc& a, const SweptArc& b) {
  const StackArc& first = *a.arc;
  const StackArc& second = *b.arc;
  const double low = std::max(first.low.y, second.low.y);
  const double high = std::min(first.high.y, second.high.y);
  if (high - low <= kMinSweptSlabHeight) return;
  if (std::max(first.low.x, first.high.x) < std::min(second.low.x, second.high.x) ||
      std::max(second.low.x, second.high.x) < std::min(first.low.x, first.high.x)) {
    return;
  }
  add_roots(a, b, low, x_at(a, low) - x_at(b, low), high, x_at(a, high) - x_at(b, high),
            kMaxBisections);
}

void CellSweep::add_crossings() {
  for (std::size_t i = 0; i < arcs_.size(); ++i) {
    for (std::size_t j = i + 1; j < arcs_.size(); ++j) add_crossings_of(arcs_[i], arcs_[j]);
  }
}

void CellSweep::set_left_side(std::span<const CellLayer> layers, double y) {
  present_ = 0;
  for (std::size_t i = 0; i < layers.size(); ++i) {
    windings_[i] = layers[i].base;
    for (const SideStep& step : layers[i].steps) {
      if (step.y <= y) windings_[i] += step.winding;
    }
    if (is_filled(windings_[i], layers[i].fill_rule)) present_ |= std::uint64_t{1} << i;
  }
}

void CellSweep::cross(const SweptArc& arc, std::span<const CellLayer> layers) {
  windings_[arc.layer] += arc.arc->winding;
  const std::uint64_t bit = std::uint64_t{1} << arc.layer;
  present_ &= ~bit;
  if (is_filled(windings_[arc.layer], layers[arc.layer].fill_rule)) present_ |= bit;
}

void CellSweep::add_part(std::uint32_t arc, double low, double high, std::uint32_t left,
                         std::uint32_t right) {
  std::uint32_t& last = arc == SweptPart::kLeftSide ? side_part_ : arcs_[arc].part;
  if (last != kNoPart) {
    SweptPart& part = parts_[last];
    if (part.high == low && part.left == left && part.right == right) {
      part.high = high;
      return;
    }
  }
  last = static_cast<std::uint32_t>(parts_.size());
  parts_.push_back({arc, low, high, left, right});
}

void CellSweep::sweep_slab(std::span<const CellLayer> layers, double low, double high) {
  const double middle = 0.5 * (low + high);
  order_.clear();
  for (std::uint32_t i = 0; i < arcs_.size(); ++i) {
    const StackArc& arc = *arcs_[i].arc;
    if (!(arc.low.y < middle && middle < arc.high.y)) continue;
    arcs_[i].x = x_at(arcs_[i], middle);
    order_.push_back(i);
  }
  work_ += 1 + order_.size();
  std::sort(order_.begin(), order_.end(), [&](std::uint32_t a, std::uint32_t b) {
    return arcs_[a].x < arcs_[b].x || (arcs_[a].x == arcs_[b].x && a < b);
  });
  set_left_side(layers, middle);
  std::uint32_t state = states_.index_of(present_);
  add_part(SweptPart::kLeftSide, low, high, kNothing, state);
  for (std::size_t i = 0; i < order_.size();) {
    const std::uint32_t first = order_[i];
    const double end = arcs_[first].x + kMinArcDistance;
    while (i < order_.size() && arcs_[order_[i]].x <= end) cross(arcs_[order_[i++]], layers);
    const std::uint32_t next = states_.index_of(present_);
    if (next != state) add_part(first, low, high, state, next);
    state = next;
  }
}

bool CellSweep::sweep(int column, int row, std::span<const CellLayer> layers,
                      std::size_t most_work) {
  center_ = {column + 0.5, row + 0.5};
  parts_.clear();
  side_part_ = kNoPart;
  states_.clear();
  states_.index_of(kNothingKey);
  windings_.resize(layers.size());
  collect_arcs(layers);
  work_ = arcs_.size() * arcs_.size() / 4;
  if (work_ > most_work) return false;
  add_crossings();
  std::sort(heights_.begin(), heights_.end());
  double low = -0.5;
  for (const double height : heights_) {
    if (height - low <= kMinSweptSlabHeight) continue;
    sweep_slab(layers, low, height);
    low = height;
    if (work_ > most_work) return false;
  }
  return true;
}

}  // namespace prefilter
