// SPDX-License-Identifier: GPL-3.0-or-later

// The grid of cells into which samples are sorted.
#pragma once

#include <array>
#include <cmath>

#include "prefilter/base/geometry.h"

namespace prefilter {

/// A cube of 2^depth cells per axis. The points' axes are rotated cyclically so that z is the
/// cloud's longest axis, which makes the slabs between two heights smallest.
struct SampleGrid {
  int depth = 0;
  int turn = 0;       // axis a of the grid is axis (a + turn) % 3 of the points
  Vector3 low{};      // corner, in the axes of the grid
  double cell = 1.0;  // the side of a finest cell

  template <typename T>
  std::array<T, 3> turned(const std::array<T, 3>& v) const {
    return {v[axis(0)], v[axis(1)], v[axis(2)]};
  }
  template <typename T>
  std::array<T, 3> turned_back(const std::array<T, 3>& v) const {
    std::array<T, 3> result;
    for (std::size_t a = 0; a < 3; ++a) result[axis(a)] = v[a];
    return result;
  }

  /// Converts a point to cells from the low corner.
  Vector3 in_cells(const Vector3& point) const {
    const Vector3 p = turned(point);
    return {(p[0] - low[0]) / cell, (p[1] - low[1]) / cell, (p[2] - low[2]) / cell};
  }
  Vector3 from_cells(const Vector3& p) const {
    return turned_back(Vector3{low[0] + cell * p[0], low[1] + cell * p[1], low[2] + cell * p[2]});
  }

 private:
  std::size_t axis(std::size_t a) const { return (a + static_cast<std::size_t>(turn)) % 3; }
};

}  // namespace prefilter
