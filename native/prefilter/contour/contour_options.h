// What a contour is made by.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "prefilter/base/progress.h"
#include "prefilter/contour/edge_crossing.h"

namespace prefilter {

struct ContourOptions {
  Interpolant interpolant = Interpolant::kOccupancy;
  float isovalue = 0.5F;  // samples of at least this are inside
  bool clean_up = false;  // collapse edges that make slivers
  int threads = 0;        // 0: all processors
  Progress progress;
};

/// Where the root is.
struct RootFrame {
  std::array<double, 3> origin{};
  std::array<double, 3> size{1.0, 1.0, 1.0};

  /// A point along an axis, given in cells of a depth from the root's low side.
  float position(int axis, double cells, int depth) const {
    return static_cast<float>(origin[axis] + std::ldexp(cells, -depth) * size[axis]);
  }

  /// The vertex on the way from a sample across a face, t cells of a depth away. It keeps a
  /// distance of a few steps of the floating-point numbers there from both samples, so that no
  /// triangle has zero area.
  float crossing(int face, double sample, double t, double distance, int depth) const {
    constexpr double kSteps = 4.0 / (1 << 24);
    constexpr double kLeast = 1e-5;
    const int axis = face / 2;
    const double largest = std::max(std::abs(origin[axis]), std::abs(origin[axis] + size[axis]));
    const double least =
        std::clamp(kSteps * largest / std::ldexp(size[axis], -depth), kLeast, 0.25) * distance;
    const double kept = std::clamp(t, least, distance - least);
    return position(axis, (face & 1) != 0 ? sample + kept : sample - kept, depth);
  }
};

}  // namespace prefilter
