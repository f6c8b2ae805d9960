// SPDX-License-Identifier: GPL-3.0-or-later

// The coordinates in which contours are made.
#pragma once

#include <algorithm>
#include <array>

#include "prefilter/base/geometry.h"
#include "prefilter/base/progress.h"
#include "prefilter/wavelet/cell_tree.h"

namespace prefilter {

/// Coordinates with their origin at the root's low corner, and its longest side for a unit: a
/// contour is the same wherever the root is and however large, and its lengths neither overflow nor
/// underflow when they are multiplied.
class RootFrame {
 public:
  explicit RootFrame(const Box& root);

  /// A point along an axis, given in cells of a depth from the root's low side.
  double position(int axis, double cells, int depth) const { return cells * cell_[axis][depth]; }

  /// The vertex on the way from a sample across a face, t cells of a depth away. It keeps a
  /// distance from both samples that remains where positions become floats relative to the root, or
  /// doubles where the root is, so that no triangle has zero area.
  double crossing(int face, double sample, double t, double distance, int depth) const {
    const int axis = face / 2;
    const double least = least_[axis][depth] * distance;
    const double kept = std::clamp(t, least, distance - least);
    return position(axis, (face & 1) != 0 ? sample + kept : sample - kept, depth);
  }

  /// The side of a cell of a depth along an axis.
  double cell(int axis, int depth) const { return cell_[axis][depth]; }

  /// The sides of a cell of a depth.
  Vector3 cells(int depth) const { return {cell(0, depth), cell(1, depth), cell(2, depth)}; }

  /// A point of the space that the root is in.
  Vector3 from_space(const Vector3& point) const { return (1.0 / unit_) * (point - origin_); }

  /// The frame's unit of length, in that space.
  double unit() const { return unit_; }

  /// Moves the vertices to where the root is. Throws Error(kCancelled).
  void place(const Progress& progress, int threads, std::vector<Vector3>* positions) const;

 private:
  Vector3 origin_;
  double unit_;
  std::array<std::array<double, kMaxTreeDepth + 1>, 3> cell_;   // of a depth: its side
  std::array<std::array<double, kMaxTreeDepth + 1>, 3> least_;  // in cells
};

}  // namespace prefilter
