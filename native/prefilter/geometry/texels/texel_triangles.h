// SPDX-License-Identifier: GPL-3.0-or-later

// The triangles of surfaces in texel coordinates, with the wrap mode applied.
#pragma once

#include <vector>

#include "prefilter/base/run.h"
#include "prefilter/base/wrap.h"
#include "prefilter/geometry/moments/triangle_cells.h"
#include "prefilter/geometry/surface.h"

namespace prefilter {

/// The area of surfaces, distributed over an image of width x height texels.
struct TexelTriangles {
  int width = 0;
  int height = 0;
  std::vector<MassTriangle> triangles;  // inside of [0, width] x [0, height]
  // Mass per squared texel spread uniformly over the whole image. It stands for whole tiles of
  // repeated textures, which would otherwise have to be cut one by one.
  double uniform_density = 0.0;
  double total_mass = 0.0;  // of the triangles and the uniform part

  double uniform_mass() const { return uniform_density * width * height; }
};

/// The mass of a triangle.
enum class MassOf {
  kArea,      // its share of the surfaces' area; an average texel gets mass 1
  kPresence,  // 1 regardless of area, to find touched texels
};

/// Transforms surfaces into texel space. Triangles that leave the unit square are cut at tile
/// lines; the parts are moved modulo 1 (repeat), clamped to the square's edge, or dropped (border),
/// as lookups would be. Throws Error if a triangle spans more than 2^20 tiles of a repeated
/// texture, or lies farther out than 2^20 (repeat) or 2^30 tiles.
TexelTriangles map_to_texels(const std::vector<const Surface*>& surfaces, int width, int height,
                             WrapModes wrap, MassOf mass_of, const Run& run);

}  // namespace prefilter
