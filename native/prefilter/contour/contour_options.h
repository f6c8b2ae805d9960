// What a contour is made by.
#pragma once

#include "prefilter/base/progress.h"

namespace prefilter {

enum class Interpolant {
  kOccupancy,  // a line that leaves each of two cells its share: chapter 5
  kPlane,      // the surface that preserves neighbouring cells
  kLinear,     // samples of a smooth function: marching cubes
};

struct ContourOptions {
  Interpolant interpolant = Interpolant::kOccupancy;
  float isovalue = 0.5F;  // samples of at least this are inside
  bool clean_up = false;  // collapse edges that make slivers
  int threads = 0;        // 0: all processors
  Progress progress;
};

}  // namespace prefilter
