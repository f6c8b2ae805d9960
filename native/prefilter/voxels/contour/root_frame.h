// SPDX-License-Identifier: GPL-3.0-or-later

// Coordinates in which contours are computed.
#pragma once

#include <algorithm>
#include <array>

#include "prefilter/base/geometry.h"
#include "prefilter/base/run.h"
#include "prefilter/wavelet/cell_tree.h"

namespace prefilter {

/// Coordinates with the origin at the root's low corner and the longest side as the unit: contours
/// do not depend on the root's position and size, and products of lengths neither overflow nor
/// underflow.
class RootFrame {
 public:
  explicit RootFrame(const Box& root);

  /// Coordinate of a point along an axis, given in cells of a depth from the root's low side.
  double position(int axis, double cells, int depth) const { return cells * cell_[axis][depth]; }

  /// Coordinate of the vertex on the way from a sample across a face, t cells of a depth away. It
  /// keeps a minimum distance from both samples that survives rounding to floats relative to the
  /// root, or to doubles at the root's position, so that no triangle has zero area.
  double crossing(int face, double sample, double t, double distance, int depth) const {
    const int axis = face / 2;
    const double least = least_[axis][depth] * distance;
    const double kept = std::clamp(t, least, distance - least);
    return position(axis, (face & 1) != 0 ? sample + kept : sample - kept, depth);
  }

  /// Side of a cell of a depth along an axis.
  double cell(int axis, int depth) const { return cell_[axis][depth]; }

  /// Sides of a cell of a depth.
  Vector3 cells(int depth) const { return {cell(0, depth), cell(1, depth), cell(2, depth)}; }

  /// Converts a point from the root's space.
  Vector3 from_space(const Vector3& point) const { return (1.0 / unit_) * (point - origin_); }

  /// The frame's unit of length in the root's space.
  double unit() const { return unit_; }

  /// Converts positions to the root's space. Throws Error(kCancelled).
  void place(const Run& run, std::vector<Vector3>* positions) const;

 private:
  Vector3 origin_;
  double unit_;
  std::array<std::array<double, kMaxTreeDepth + 1>, 3> cell_;   // side per depth
  std::array<std::array<double, kMaxTreeDepth + 1>, 3> least_;  // minimum distance, in cells
};

}  // namespace prefilter
