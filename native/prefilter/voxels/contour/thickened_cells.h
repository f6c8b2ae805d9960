// SPDX-License-Identifier: GPL-3.0-or-later

// Cells in which a surface differs from its sources because they were thickened.
#pragma once

#include <cmath>

#include "prefilter/base/geometry.h"
#include "prefilter/voxels/contour/root_frame.h"
#include "prefilter/wavelet/cell_tree.h"
#include "prefilter/wavelet/leaf_surface.h"

namespace prefilter {

class ThickenedCells {
 public:
  /// The cells of a tree with values above 0; `cells` may be null.
  ThickenedCells(const CellTree* cells, const RootFrame& frame)
      : cells_(cells != nullptr && !cells->levels.empty() ? cells : nullptr), frame_(frame) {}

  /// Whether a point of the frame is in a thickened cell.
  bool holds(const Vector3& point) const {
    if (cells_ == nullptr) return false;
    const int depth = cells_->depth();
    LeafPlace place;
    for (int a = 0; a < 3; ++a) {
      place[static_cast<std::size_t>(a)] =
          static_cast<int>(std::floor(point[a] / frame_.cell(a, depth)));
    }
    return occupancy_at(*cells_, depth, place) > 0.0F;
  }

 private:
  const CellTree* cells_;
  const RootFrame& frame_;
};

}  // namespace prefilter
