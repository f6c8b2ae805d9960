// SPDX-License-Identifier: GPL-3.0-or-later

// Gauss-Legendre rules in the slabs of CellSlabs.
#include "prefilter/shapes/raster/cell_quadrature.h"

#include <algorithm>
#include <cmath>

#include "prefilter/base/gauss_rule.h"
#include "prefilter/images/kernel.h"

namespace prefilter {
namespace {

// Parallelograms along a cell's side over which fine stops are averaged. Filters of higher degree
// evaluate their polynomial at the centers and need more.
constexpr double kFinePartsOfBox = 4.0;
constexpr double kFinePartsOfOthers = 8.0;

}  // namespace

CellQuadrature::Rule CellQuadrature::rule_of(int points) {
  const auto of = [](const auto& rule) { return Rule{rule.nodes, rule.weights}; };
  switch (points) {
    case 2:
      return of(gauss_rule<2>());
    case 3:
      return of(gauss_rule<3>());
    case 4:
      return of(gauss_rule<4>());
    case 5:
      return of(gauss_rule<5>());
    case 6:
      return of(gauss_rule<6>());
    default:
      return of(gauss_rule<10>());
  }
}

// Along x a filter's power is multiplied by colors, which are integrated exactly up to degree 5.
// Along y the width of a part and the effect of its slanted sides add to the degree.
CellQuadrature::CellQuadrature(int degree)
    : degree_(degree),
      along_(rule_of(3 + (degree + 1) / 2)),
      across_(rule_of(std::min(3 + degree, 3 + Kernel::kMostDegree))) {
  static_assert(Kernel::kMostDegree == 7);
}

void CellQuadrature::begin(const CellColors& colors) {
  channels_ = colors.channels();
  has_fine_stops_ = colors.has_fine_stops();
  const auto count = static_cast<std::size_t>(degree_ + 1) * (degree_ + 1);
  for (int c = 0; c < channels_; ++c) sums_[c].assign(count, 0.0);
  const bool takes_few = degree_ == 0 && colors.is_gentle();
  cell_along_ = takes_few ? rule_of(2) : along_;
  cell_across_ = takes_few ? rule_of(2) : across_;
}

void CellQuadrature::add_value(const ChannelValues& value, const Point2& point, double weight) {
  if (degree_ == 0) {
    for (int c = 0; c < channels_; ++c) sums_[c][0] += weight * value[c];
    return;
  }
  double by_x = weight;
  std::size_t place = 0;
  for (int a = 0; a <= degree_; ++a) {
    double power = by_x;
    for (int b = 0; b <= degree_; ++b) {
      for (int c = 0; c < channels_; ++c) sums_[c][place] += power * value[c];
      power *= point.y;
      ++place;
    }
    by_x *= point.x;
  }
}

void CellQuadrature::add_row(const CellColors& colors, std::uint64_t present, double left,
                             double width, double y, double weight) {
  for (std::size_t i = 0; i < cell_along_.nodes.size(); ++i) {
    const Point2 point{left + width * cell_along_.nodes[i], y};
    add_value(colors.compose_at(present, {point, {}, {}}), point,
              weight * width * cell_along_.weights[i]);
  }
}

void CellQuadrature::set_parts(std::span<const CellLayer> layers, const CellColors& colors) {
  parts_.clear();
  const auto add = [&](std::uint64_t present) {
    parts_.push_back(
        {present, colors.is_visible_where(present), !colors.is_constant_where(present)});
  };
  add(slabs_.left_side());
  for (const std::uint32_t i : slabs_.order()) {
    add(slabs_.cross(slabs_.arc(i), layers, parts_.back().present));
  }
}

void CellQuadrature::add_slab(std::span<const CellLayer> layers, const CellColors& colors,
                              double low, double high) {
  set_parts(layers, colors);
  if (degree_ == 0 && add_constant_slab(colors, low, high)) return;
  if (has_fine_stops_) {
    add_fine_slab(colors, low, high);
    return;
  }
  const double height = high - low;
  for (std::size_t j = 0; j < cell_across_.nodes.size(); ++j) {
    const double y = low + height * cell_across_.nodes[j];
    const double weight = height * cell_across_.weights[j];
    double left = -0.5;
    for (std::size_t k = 0; k < parts_.size(); ++k) {
      // At least the previous arc's x, so that the widths add up to 1 in any order of the arcs.
      const double right = k < slabs_.order().size()
                               ? std::clamp(slabs_.arc(slabs_.order()[k]).x_at(y), left, 0.5)
                               : 0.5;
      const Part& part = parts_[k];
      if (right > left && part.is_visible) {
        if (part.varies || degree_ > 0) {
          add_row(colors, part.present, left, right - left, y, weight);
        } else {
          add_value(colors.compose_at(part.present, {{left, y}, {}, {}}), {},
                    weight * (right - left));
        }
      }
      left = right;
    }
  }
}

void CellQuadrature::add_fine_slab(const CellColors& colors, double low, double high) {
  const double parts = degree_ == 0 ? kFinePartsOfBox : kFinePartsOfOthers;
  const double rows = std::ceil(parts * (high - low));
  const double height = (high - low) / rows;
  for (double row = 0.0; row < rows; row += 1.0) {
    add_fine_row(colors, low + row * height, low + (row + 1.0) * height);
  }
}

void CellQuadrature::add_fine_row(const CellColors& colors, double low, double high) {
  // An arc's x at the middle of the row, and its shift over the row's height.
  double left = -0.5;
  double left_shift = 0.0;
  for (std::size_t k = 0; k < parts_.size(); ++k) {
    double right = 0.5;
    double right_shift = 0.0;
    if (k < slabs_.order().size()) {
      const CellSlabs::Arc& arc = slabs_.arc(slabs_.order()[k]);
      right = std::clamp(arc.x_at(0.5 * (low + high)), left, 0.5);
      right_shift = std::clamp(arc.x_at(high), -0.5, 0.5) - std::clamp(arc.x_at(low), -0.5, 0.5);
    }
    if (right > left && parts_[k].is_visible) {
      add_parallelograms(colors, parts_[k].present, {left, left_shift}, {right, right_shift}, low,
                         high);
    }
    left = right;
    left_shift = right_shift;
  }
}

void CellQuadrature::add_parallelograms(const CellColors& colors, std::uint64_t present,
                                        const FineSide& left, const FineSide& right, double low,
                                        double high) {
  const double parts = degree_ == 0 ? kFinePartsOfBox : kFinePartsOfOthers;
  const double count = std::ceil(parts * (right.x - left.x));
  const double width = (right.x - left.x) / count;
  const double height = high - low;
  for (double i = 0.5; i < count; i += 1.0) {
    const double shift = left.shift + (right.shift - left.shift) * (i / count);
    const Point2 center{left.x + i * width, 0.5 * (low + high)};
    const CellColors::Spot spot{center, {width, 0.0}, {shift, height}};
    add_value(colors.compose_at(present, spot), center, width * height);
  }
}

// Adds a slab whose colors are constant from areas. Returns false if a color varies.
bool CellQuadrature::add_constant_slab(const CellColors& colors, double low, double high) {
  if (std::any_of(parts_.begin(), parts_.end(), [](const Part& part) { return part.varies; })) {
    return false;
  }
  const double height = high - low;
  double left = -0.5;
  for (std::size_t k = 0; k < parts_.size(); ++k) {
    double right = 0.5;
    if (k < slabs_.order().size()) {
      // A parabola's mean is its value at the middle plus a twelfth of its second difference.
      const CellSlabs::Arc& arc = slabs_.arc(slabs_.order()[k]);
      right = std::clamp(arc.x + arc.bend * height * height / 12.0, left, 0.5);
    }
    if (right > left && parts_[k].is_visible) {
      add_value(colors.compose_at(parts_[k].present, {{left, low}, {}, {}}), {},
                height * (right - left));
    }
    left = right;
  }
  return true;
}

bool CellQuadrature::find(std::span<const CellLayer> layers, const CellColors& colors,
                          std::size_t most_work) {
  begin(colors);
  return slabs_.visit(layers, most_work,
                      [&](double low, double high) { add_slab(layers, colors, low, high); });
}

void CellQuadrature::find_full(const CellColors& colors) {
  begin(colors);
  if (has_fine_stops_) {
    const double parts = degree_ == 0 ? kFinePartsOfBox : kFinePartsOfOthers;
    for (double row = 0.0; row < parts; row += 1.0) {
      add_parallelograms(colors, 0, {-0.5, 0.0}, {0.5, 0.0}, row / parts - 0.5,
                         (row + 1.0) / parts - 0.5);
    }
    return;
  }
  for (std::size_t j = 0; j < cell_along_.nodes.size(); ++j) {
    add_row(colors, 0, -0.5, 1.0, cell_along_.nodes[j] - 0.5, cell_along_.weights[j]);
  }
}

}  // namespace prefilter
