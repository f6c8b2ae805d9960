// SPDX-License-Identifier: GPL-3.0-or-later

// Where a surface lies in an image: its triangles in texel units, after the wrap mode.
#pragma once

#include <vector>

#include "prefilter/base/progress.h"
#include "prefilter/base/wrap.h"
#include "prefilter/geometry/moments/triangle_cells.h"
#include "prefilter/geometry/surface.h"

namespace prefilter {

/// A surface's area as it lies in an image of width x height texels.
struct TexelTriangles {
  int width = 0;
  int height = 0;
  std::vector<MassTriangle> triangles;  // inside of [0, width] x [0, height]
  // Mass by squared texel that lies evenly on all of the image: the whole tiles of repeated
  // textures, which would otherwise be cut one by one.
  double uniform_density = 0.0;
  double total_mass = 0.0;  // what the triangles and the uniform part hold together

  double uniform_mass() const { return uniform_density * width * height; }
};

/// What a triangle's mass is.
enum class MassOf {
  kArea,      // its share of the surface's area; an average texel gets mass 1
  kPresence,  // 1, whatever its area: for coverage
};

/// Carries surfaces into texel space. Triangles that leave the unit square are cut at tile lines
/// and taken modulo (repeat), clamped to the square's edge, or dropped there (border), as a lookup
/// would be.
/// Throws Error where a triangle spans more than 2^20 tiles of a repeated texture, or lies farther
/// out than 2^20 (repeat) or 2^30 tiles.
TexelTriangles map_to_texels(const std::vector<const Surface*>& surfaces, int width, int height,
                             WrapModes wrap, MassOf mass_of, const Progress& progress, int threads);

}  // namespace prefilter
