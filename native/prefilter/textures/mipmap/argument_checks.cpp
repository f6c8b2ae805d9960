// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/textures/mipmap/argument_checks.h"

#include <cmath>
#include <limits>
#include <string>

#include "prefilter/base/error.h"
#include "prefilter/base/text.h"

namespace prefilter {

ValueRange range_of(const Bounds& bounds) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  const ValueRange range = {bounds.low.value_or(-kInfinity), bounds.high.value_or(kInfinity)};
  if (!(range.low <= range.high) || range.low == kInfinity || range.high == -kInfinity) {
    throw_invalid("bounds: the low bound is " + (bounds.low ? to_text(*bounds.low) : "open") +
                  " and the high bound is " + (bounds.high ? to_text(*bounds.high) : "open") +
                  "; numbers are needed, and low must not be above high");
  }
  return range;
}

void check_surface_area(const std::vector<const Surface*>& surfaces) {
  double area = 0.0;
  for (const Surface* surface : surfaces) area += surface->total_area();
  if (!(area > 0.0) || !std::isfinite(area)) {
    throw_invalid("surface: the triangles have an area of " + to_text(area) +
                  " in all; a positive, finite one is needed");
  }
}

void check_mapped(const TexelTriangles& triangles) {
  if (!(triangles.total_mass > 0.0)) throw_outside();
}

void throw_outside() {
  throw_invalid(
      "surface: none of it lies inside the image, and with the wrap mode border nothing else "
      "counts; use clamp or repeat, or move the uvs");
}

}  // namespace prefilter
