// SPDX-License-Identifier: GPL-3.0-or-later

// Loops of a contour whose triangles are chosen anew.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "prefilter/base/geometry.h"

namespace prefilter {

/// The places of vertices in a grid, in halves of a cell: those between two cells have one even
/// coordinate.
using GridPlace = std::array<std::int32_t, 3>;

/// Where a vertex is that is not between two cells.
inline constexpr GridPlace kNoPlace = {0, 0, 0};

/// Triangulates the loops that have a triangle of one of the pairs anew, where fewer of their edges
/// then fold. A loop is in the cube between the centers of eight cells, and no diagonal of it in a
/// face of that. Returns whether any has changed.
bool unfold_loops(std::span<const Vector3> positions, std::span<const GridPlace> places,
                  std::span<const std::array<std::uint32_t, 2>> pairs,
                  std::vector<std::array<std::int32_t, 3>>* triangles);

}  // namespace prefilter
