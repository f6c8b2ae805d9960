// SPDX-License-Identifier: GPL-3.0-or-later

// Where the line between two cells' centers meets the surface that preserves the volume of the
// neighboring cells.
//
// Beyond the text, whose two samples cannot fix a plane in space. Along the axis that the surface
// faces most, the occupancies of a column of cells, from full ones to empty ones, add up to the
// mean height of the surface over the column. Means of five columns, a cross, give a quadratic:
// exact for planes, and of fourth order on smooth surfaces where the line is such a column (height
// functions of the volume-of-fluid literature, Cummins et al. 2005).
#pragma once

#include <array>
#include <cstddef>
#include <optional>

namespace prefilter {

/// Cells that may be read on all sides of the two.
inline constexpr int kHeightReach = 6;

/// The crossing between a cell, at `cell`, and its neighbor across a face (2 a for the low one
/// across axis a, 2 a + 1 for the high one), as the distance from the cell's center in [0, 1]; one
/// of the two is at least 1/2. `strides` lead to the next cell along the axes. None where columns
/// do not run from full to empty cells within reach: at thin parts, sharp corners and noise.
std::optional<float> height_crossing(const float* cell,
                                     const std::array<std::ptrdiff_t, 3>& strides, int face);

/// The height of the surface over the cell's center along the axis that it faces most, in cells, so
/// that the center is inside where it is positive; none as above.
std::optional<float> height_over_center(const float* cell,
                                        const std::array<std::ptrdiff_t, 3>& strides);

/// Whether the surface around the two cells is smooth, as the heights of the columns there tell.
bool is_smooth_at(const float* cell, const std::array<std::ptrdiff_t, 3>& strides, int face);

}  // namespace prefilter
