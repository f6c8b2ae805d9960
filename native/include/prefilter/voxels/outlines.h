// SPDX-License-Identifier: GPL-3.0-or-later

// Contours grids of samples in the plane as closed outlines (section 5.2).
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "prefilter/voxels/contour_options.h"

namespace prefilter {

/// Samples at [x * size[1] + y], at the centers of cells (x + 1/2, y + 1/2).
struct PlaneView {
  const float* values = nullptr;
  std::array<int, 2> size{};  // cells along the axes, 1 to 4096

  float at(int x, int y) const {
    return values[static_cast<std::size_t>(x) * static_cast<std::size_t>(size[1]) +
                  static_cast<std::size_t>(y)];
  }
};

/// Position of the cells: cell (i, j) begins at origin + spacing * (i, j).
struct PlaneFrame {
  std::array<double, 2> origin{};
  std::array<double, 2> spacing{1.0, 1.0};
};

/// A closed polygon without a repeated end point; the inside is on the left.
using OutlinePoints = std::vector<std::array<double, 2>>;

/// The outlines of the region inside. "occupancy" and "plane" are equivalent here: exact for
/// straight edges. The options `clean_up` and `threads` have no effect. Throws Error where a side
/// is out of range, a sample is not a number, or the frame's cells have no area; Error(kCancelled).
std::vector<OutlinePoints> contour_outlines(const PlaneView& samples, const PlaneFrame& frame,
                                            const ContourOptions& options);

}  // namespace prefilter
