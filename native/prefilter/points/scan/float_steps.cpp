// SPDX-License-Identifier: GPL-3.0-or-later

// Counts the coordinates that are odd multiples of the single-precision spacing.
#include "prefilter/points/float_steps.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

namespace prefilter {
namespace {

constexpr std::size_t kPointsPerOddPoint = 8;  // at least one in this many must be odd

}  // namespace

void FloatSteps::add(const Vector3& point) {
  for (std::size_t a = 0; a < 3; ++a) {
    Axis& axis = axes_[a];
    const double value = std::abs(point[a]);
    if (!(value <= static_cast<double>(std::numeric_limits<float>::max()))) continue;
    const auto narrow = static_cast<float>(value);
    ++axis.count;
    axis.is_wide = axis.is_wide || static_cast<double>(narrow) != value;
    axis.odd += std::bit_cast<std::uint32_t>(narrow) & 1U;
    axis.largest = std::max(axis.largest, value);
  }
}

void FloatSteps::add(const FloatSteps& other) {
  for (std::size_t a = 0; a < 3; ++a) {
    axes_[a].count += other.axes_[a].count;
    axes_[a].odd += other.axes_[a].odd;
    axes_[a].is_wide = axes_[a].is_wide || other.axes_[a].is_wide;
    axes_[a].largest = std::max(axes_[a].largest, other.axes_[a].largest);
  }
}

double FloatSteps::step() const {
  double largest = 0.0;
  for (const Axis& axis : axes_) {
    if (axis.is_wide || kPointsPerOddPoint * axis.odd < axis.count || axis.odd == 0) continue;
    const auto narrow = static_cast<float>(axis.largest);
    largest = std::max(
        largest, static_cast<double>(narrow) - static_cast<double>(std::nextafter(narrow, 0.0F)));
  }
  return largest;
}

}  // namespace prefilter
