// SPDX-License-Identifier: GPL-3.0-or-later

// Quads as two triangles each.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "prefilter/base/geometry.h"

namespace prefilter {

using Quad = std::array<std::int32_t, 4>;

/// Closed quads, of one label each or kNoLabel. Renderers cut them from the first corner to the
/// third.
struct QuadSurface {
  std::vector<Vector3> positions;
  std::vector<Quad> quads;
  std::vector<std::int32_t> labels;

  /// The triangles 2 i and 2 i + 1 of each quad i.
  std::vector<std::array<std::int32_t, 3>> triangles() const;

  /// Has a quad begin at the corner from which it is best cut: flat, and next to Delaunay's.
  void turn(std::size_t quad);
};

}  // namespace prefilter
