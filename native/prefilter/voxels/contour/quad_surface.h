// SPDX-License-Identifier: GPL-3.0-or-later

// Quads as pairs of triangles.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "prefilter/base/geometry.h"

namespace prefilter {

using Quad = std::array<std::int32_t, 4>;

/// A closed surface of quads, each with a label or kNoLabel. Renderers divide quads between the
/// first and the third corner.
struct QuadSurface {
  std::vector<Vector3> positions;
  std::vector<Quad> quads;
  std::vector<std::int32_t> labels;

  /// Triangles 2 i and 2 i + 1 for each quad i.
  std::vector<std::array<std::int32_t, 3>> triangles() const;

  /// Rotates a quad so that its division is best: flat, and close to Delaunay.
  void turn(std::size_t quad);
};

}  // namespace prefilter
