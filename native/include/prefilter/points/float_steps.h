// SPDX-License-Identifier: GPL-3.0-or-later

// Coordinates that were rounded to single precision, far from the origin.
#pragma once

#include <array>
#include <cstddef>

#include "prefilter/base/geometry.h"

namespace prefilter {

/// Finds out whether coordinates have gone through single precision, whose numbers are a step apart
/// that grows with their distance from 0: 1/2 for a northing of five million. They have, if all are
/// such numbers, and one in eight or more are no number of half that precision, as coordinates with
/// few digits would be.
class FloatSteps {
 public:
  void add(const Vector3& point);
  void add(const FloatSteps& other);

  /// What was found along each axis.
  struct Axis {
    std::size_t count = 0;
    std::size_t odd = 0;   // multiples of the step, and not of twice that
    bool is_wide = false;  // one is between numbers of single precision
    double largest = 0.0;
  };
  FloatSteps() = default;
  explicit FloatSteps(const std::array<Axis, 3>& axes) : axes_(axes) {}
  const std::array<Axis, 3>& axes() const { return axes_; }

  /// The largest step along an axis whose coordinates were rounded; 0 where none were.
  double step() const;

 private:
  std::array<Axis, 3> axes_;
};

}  // namespace prefilter
