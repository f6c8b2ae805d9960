// SPDX-License-Identifier: GPL-3.0-or-later

// Intersection of the line between two cells' centers with the surface that preserves the volume of
// the neighboring cells.
//
// Not in the dissertation, whose two samples cannot determine a plane in space. Along the axis that
// the surface faces most, the occupancies of a column of cells, from full to empty, sum to the mean
// height of the surface over the column. The means of a cross of five columns define a quadratic.
// It is exact for planes, and of fourth order on smooth surfaces if the line is such a column
// (height functions of volume-of-fluid methods; S. Cummins et al., Estimating curvature from volume
// fractions, 2005).
// functions of the volume-of-fluid literature, Cummins et al. 2005).
#pragma once

#include <array>
#include <cstddef>
#include <optional>

namespace prefilter {

/// Number of cells that may be read beyond the two on all sides.
inline constexpr int kHeightReach = 6;

/// The crossing between a cell, at `cell`, and its neighbor across a face (2 a for the low face
/// across axis a, 2 a + 1 for the high one), as the distance from the cell's center, in [0, 1]; one
/// of the two occupancies must be at least 1/2. `strides` lead to the next cell along each axis.
/// None where columns do not run from full to empty cells within reach: at thin parts, sharp
/// corners and noise.
std::optional<float> height_crossing(const float* cell,
                                     const std::array<std::ptrdiff_t, 3>& strides, int face);

/// The height of the surface over the cell's center along the axis that it faces most, in cells;
/// positive if the center is inside. None as above.
std::optional<float> height_over_center(const float* cell,
                                        const std::array<std::ptrdiff_t, 3>& strides);

/// Whether the heights of the columns around the two cells indicate a smooth surface.
bool is_smooth_at(const float* cell, const std::array<std::ptrdiff_t, 3>& strides, int face);

}  // namespace prefilter
