// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/mipmap/argument_checks.h"

#include <cmath>
#include <string>

#include "prefilter/base/error.h"
#include "prefilter/base/text.h"

namespace prefilter {

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
