// SPDX-License-Identifier: GPL-3.0-or-later

// Retriangulates loops of a contour.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "prefilter/base/geometry.h"

namespace prefilter {

/// Grid positions of vertices, in halves of a cell; positions between two cells have one even
/// coordinate.
using GridPlace = std::array<std::int32_t, 3>;

/// Grid position of vertices that are not between two cells.
inline constexpr GridPlace kNoPlace = {0, 0, 0};

/// Retriangulates the loops with triangles of the given pairs if that reduces the folds of their
/// edges. A loop lies in the cube between the centers of eight cells, and its diagonals do not lie
/// in faces of the cube. Returns whether any loop changed.
bool unfold_loops(std::span<const Vector3> positions, std::span<const GridPlace> places,
                  std::span<const std::array<std::uint32_t, 2>> pairs,
                  std::vector<std::array<std::int32_t, 3>>* triangles);

}  // namespace prefilter
