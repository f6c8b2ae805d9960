// What a contour is made by.
#pragma once

#include <array>

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
};

}  // namespace prefilter
