// SPDX-License-Identifier: GPL-3.0-or-later

// Adjacency of sharp loops.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "prefilter/base/run.h"
#include "prefilter/voxels/contour/feature_surface.h"
#include "prefilter/voxels/contour/looped_mesh.h"
#include "prefilter/voxels/contour/sharp_vertices.h"

namespace prefilter {

/// A side of a loop.
struct LoopSide {
  bool is_divided = false;  // an edge of the shape crosses it
  std::int32_t other = -1;  // the adjacent loop, if the two can be joined across the side
  // Bit k: an earlier loop has the vertex at which the side begins, and corner k of this loop.
  std::uint16_t shared = 0;
};

/// Sharp loops and their adjacency.
struct LinkedLoops {
  std::vector<SharpLoop> loops;
  std::vector<std::array<LoopSide, 12>> sides;  // per loop

  std::size_t size() const { return loops.size(); }
  std::size_t side_count(std::size_t loop) const {
    return static_cast<std::size_t>(loops[loop].count);
  }
  /// Whether a loop is joined across a side to one that is still sharp.
  bool is_joined(std::size_t loop, std::size_t side, std::span<const std::uint8_t> is_sharp) const {
    const std::int32_t other = sides[loop][side].other;
    return other >= 0 && is_sharp[static_cast<std::size_t>(other)] != 0;
  }
  /// The loops joined to a loop, in order of its sides.
  std::vector<std::size_t> joined(std::size_t loop, std::span<const std::uint8_t> is_sharp) const;
};

/// Whether an edge of the shape passes between two vertices.
bool are_divided(const FeatureSurface& surface, const VertexSamples& samples, std::int32_t a,
                 std::int32_t b);

/// Finds the sides that edges cross. Two loops can be joined if they share exactly one such side.
/// Throws Error(kCancelled).
LinkedLoops link_loops(std::vector<SharpLoop> loops, const FeatureSurface& surface,
                       const VertexSamples& samples, const Run& run);

}  // namespace prefilter
