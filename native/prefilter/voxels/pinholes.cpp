// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/voxels/pinholes.h"

#include <cstddef>
#include <vector>

#include "prefilter/voxels/finest_cells.h"

namespace prefilter {
namespace {

constexpr float kPinholeMinOccupancy = 0.4F;  // emptier cells stay
constexpr float kHalfFull = 0.5F;
constexpr float kFilledOccupancy = 0.505F;  // just full
constexpr int kMinFullNeighbors = 4;

bool is_pinhole(const CellTree& cells, int depth, const LeafPlace& at) {
  const float value = occupancy_at(cells, depth, at);
  if (!(value >= kPinholeMinOccupancy && value <= kHalfFull)) return false;
  int count = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (const int step : {-1, 1}) {
      LeafPlace beside = at;
      beside[axis] += step;
      if (occupancy_at(cells, depth, beside) > kHalfFull) ++count;
    }
  }
  return count >= kMinFullNeighbors;
}

}  // namespace

void fill_pinholes(const CellTree& thickened, int depth, const Run& run, CellTree* cells) {
  if (thickened.depth() != depth || cells->depth() != depth || depth == 0) return;
  std::vector<LeafPlace> holes;
  for_finest(thickened, [&](const LeafPlace& at, float) {
    if (is_pinhole(*cells, depth, at)) holes.push_back(at);
  });
  for (const LeafPlace& at : holes) set_leaf(at, depth, kFilledOccupancy, cells);
  if (!holes.empty()) update_means(cells, run);
}

}  // namespace prefilter
