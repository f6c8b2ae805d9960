// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/voxel/pinholes.h"

#include <array>
#include <cstddef>
#include <vector>

#include "prefilter/wavelet/leaf_surface.h"

namespace prefilter {
namespace {

constexpr float kNearly = 0.4F;
constexpr float kHalf = 0.5F;
constexpr float kFilled = 0.505F;
constexpr int kMostNeighbors = 4;

// The finest cells of a tree that are not empty.
template <typename Visit>
void for_finest(const CellTree& tree, int level, std::size_t block, const LeafPlace& at,
                const Visit& visit) {
  const TreeLevel& here = tree.levels[static_cast<std::size_t>(level)];
  for (int o = 0; o < 8; ++o) {
    const LeafPlace octant = octant_place(at, o);
    if (here.is_split(block, o)) {
      for_finest(tree, level + 1, here.child(block, o), octant, visit);
    } else if (level + 1 == tree.depth() &&
               here.blocks[block][static_cast<std::size_t>(o)] > 0.0F) {
      visit(octant);
    }
  }
}

bool is_pinhole(const CellTree& cells, int depth, const LeafPlace& at) {
  const float value = occupancy_at(cells, depth, at);
  if (!(value >= kNearly && value <= kHalf)) return false;
  int count = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (const int step : {-1, 1}) {
      LeafPlace beside = at;
      beside[axis] += step;
      if (occupancy_at(cells, depth, beside) > kHalf) ++count;
    }
  }
  return count >= kMostNeighbors;
}

// Sets the value of a leaf of the finest depth; what is not as fine stays.
void set_leaf(const LeafPlace& at, int depth, float value, CellTree* cells) {
  std::size_t block = 0;
  for (int k = 0; k < depth; ++k) {
    const int shift = depth - k - 1;
    const int o =
        ((at[0] >> shift) & 1) | (((at[1] >> shift) & 1) << 1) | (((at[2] >> shift) & 1) << 2);
    TreeLevel& level = cells->levels[static_cast<std::size_t>(k)];
    if (k + 1 == depth) {
      level.blocks[block][static_cast<std::size_t>(o)] = value;
    } else if (!level.is_split(block, o)) {
      return;
    } else {
      block = level.child(block, o);
    }
  }
}

}  // namespace

void fill_pinholes(const CellTree& thickened, int depth, const Progress& progress, int threads,
                   CellTree* cells) {
  if (thickened.depth() != depth || cells->depth() != depth || depth == 0) return;
  std::vector<LeafPlace> holes;
  for_finest(thickened, 0, 0, {0, 0, 0}, [&](const LeafPlace& at) {
    if (is_pinhole(*cells, depth, at)) holes.push_back(at);
  });
  for (const LeafPlace& at : holes) set_leaf(at, depth, kFilled, cells);
  if (!holes.empty()) update_means(cells, progress, threads);
}

}  // namespace prefilter
