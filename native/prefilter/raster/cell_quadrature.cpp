// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/raster/cell_quadrature.h"

#include <algorithm>

#include "prefilter/base/gauss_rule.h"
#include "prefilter/filters/kernel.h"

namespace prefilter {

CellQuadrature::Rule CellQuadrature::rule_of(int points) {
  const auto of = [](const auto& rule) { return Rule{rule.nodes, rule.weights}; };
  switch (points) {
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

// Along x a filter's power is multiplied with colors of degree 5 at least. Along y the width of a
// part comes to that, and what integrals along x bring of slanted sides.
CellQuadrature::CellQuadrature(int degree)
    : degree_(degree),
      along_(rule_of(3 + (degree + 1) / 2)),
      across_(rule_of(std::min(3 + degree, 3 + Kernel::kMostDegree))) {
  static_assert(Kernel::kMostDegree == 7);
}

void CellQuadrature::clear() {
  const auto count = static_cast<std::size_t>(degree_ + 1) * (degree_ + 1);
  for (int c = 0; c < channels_; ++c) sums_[c].assign(count, 0.0);
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
  for (std::size_t i = 0; i < along_.nodes.size(); ++i) {
    const Point2 point{left + width * along_.nodes[i], y};
    add_value(colors.compose_at(present, point), point, weight * width * along_.weights[i]);
  }
}

void CellQuadrature::add_slab(std::span<const CellLayer> layers, const CellColors& colors,
                              double low, double high) {
  present_.assign(1, slabs_.left_side());
  for (const std::uint32_t i : slabs_.order()) {
    present_.push_back(slabs_.cross(slabs_.arc(i), layers, present_.back()));
  }
  const double height = high - low;
  for (std::size_t j = 0; j < across_.nodes.size(); ++j) {
    const double y = low + height * across_.nodes[j];
    const double weight = height * across_.weights[j];
    double left = -0.5;
    for (std::size_t k = 0; k < present_.size(); ++k) {
      // Not left of the arc before, so that the widths add up to 1 in whatever order arcs are.
      const double right = k < slabs_.order().size()
                               ? std::clamp(slabs_.arc(slabs_.order()[k]).x_at(y), left, 0.5)
                               : 0.5;
      if (right > left) add_row(colors, present_[k], left, right - left, y, weight);
      left = right;
    }
  }
}

bool CellQuadrature::find(std::span<const CellLayer> layers, const CellColors& colors,
                          std::size_t most_work) {
  channels_ = colors.channels();
  clear();
  return slabs_.visit(layers, most_work, [&](double low, double high) {
    add_slab(layers, colors, low, high);
  });
}

void CellQuadrature::find_full(const CellColors& colors) {
  channels_ = colors.channels();
  clear();
  for (std::size_t j = 0; j < along_.nodes.size(); ++j) {
    add_row(colors, 0, -0.5, 1.0, along_.nodes[j] - 0.5, along_.weights[j]);
  }
}

}  // namespace prefilter
