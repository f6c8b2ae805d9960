// SPDX-License-Identifier: GPL-3.0-or-later

// Detects coordinates rounded to single precision far from the origin.
#pragma once

#include <array>
#include <cstddef>

#include "prefilter/base/geometry.h"

namespace prefilter {

/// Detects whether coordinates have been stored in single precision, whose spacing grows with the
/// distance from 0: 1/2 for a northing of five million. This is assumed if all coordinates are such
/// numbers, and at least one in eight is an odd multiple of the spacing; coordinates with few
/// digits would not be.
class FloatSteps {
 public:
  void add(const Vector3& point);
  void add(const FloatSteps& other);

  /// Statistics along an axis.
  struct Axis {
    std::size_t count = 0;
    std::size_t odd = 0;   // odd multiples of the spacing
    bool is_wide = false;  // a coordinate is not exact in single precision
    double largest = 0.0;
  };
  FloatSteps() = default;
  explicit FloatSteps(const std::array<Axis, 3>& axes) : axes_(axes) {}
  const std::array<Axis, 3>& axes() const { return axes_; }

  /// The largest spacing along an axis whose coordinates were rounded; 0 if none were.
  double step() const;

 private:
  std::array<Axis, 3> axes_;
};

}  // namespace prefilter
