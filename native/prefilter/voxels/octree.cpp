// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/voxels/octree.h"

#include <cmath>
#include <string>
#include <utility>

#include "prefilter/base/error.h"
#include "prefilter/base/text.h"

namespace prefilter {
namespace {
void check_occupancy(float value) {
  if (value >= 0.0F && value <= 1.0F) return;
  throw_invalid("values: found " + to_text(value) + "; occupancies from 0 to 1 are needed");
}

void check_levels(const std::vector<TreeLevel>& levels, float root, int depth) {
  if (levels.size() > static_cast<std::size_t>(depth)) {
    throw_invalid("levels: " + std::to_string(levels.size()) + " of them; a tree of depth " +
                  std::to_string(depth) + " has no more than that");
  }
  check_occupancy(root);
  std::size_t wanted = 1;
  for (std::size_t k = 0; k < levels.size(); ++k) {
    const TreeLevel& level = levels[k];
    if (level.size() != wanted || level.split.size() != wanted) {
      throw_invalid("levels: level " + std::to_string(k) + " has " + std::to_string(level.size()) +
                    " blocks and " + std::to_string(level.split.size()) +
                    " sets of split octants; the level above it asks for " +
                    std::to_string(wanted));
    }
    wanted = 0;
    for (const std::uint8_t split : level.split) wanted += std::popcount(split);
    for (const OctantValues& block : level.blocks) {
      for (const float value : block) check_occupancy(value);
    }
    if (wanted == 0 && k + 1 < levels.size()) {
      throw_invalid("levels: nothing is split on level " + std::to_string(k) +
                    ", but there are more levels");
    }
  }
  if (wanted != 0 && !levels.empty()) {
    throw_invalid("levels: octants of the last level are split; the blocks of these are missing");
  }
}
}  // namespace

double Octree::cell_size(int axis, int at_depth) const {
  return std::ldexp(bounds.size(axis), -at_depth);
}

Octree coarsened(const Octree& octree, int depth) {
  check_depth(depth, 0, "depth");
  Octree result = octree;
  result.depth = std::min(octree.depth, depth);
  if (octree.cells.depth() <= depth) return result;
  result.cells.levels.resize(static_cast<std::size_t>(depth));
  if (depth > 0) {
    TreeLevel& last = result.cells.levels.back();
    std::fill(last.split.begin(), last.split.end(), std::uint8_t{0});
    link_blocks(&last);
  }
  return result;
}

Octree make_octree(std::vector<TreeLevel> levels, float root, const Box& bounds, int depth) {
  check_box(bounds, "bounds");
  check_depth(depth, 0, "depth");
  check_levels(levels, root, depth);
  Octree octree{{root, std::move(levels)}, bounds, depth, {}};
  for (TreeLevel& level : octree.cells.levels) link_blocks(&level);
  update_means(&octree.cells, Run(1));
  return octree;
}

void check_depth(int depth, int low, const char* argument) {
  if (depth >= low && depth <= kMaxTreeDepth) return;
  throw_invalid(std::string(argument) + ": " + std::to_string(depth) + "; a whole number from " +
                std::to_string(low) + " to " + std::to_string(kMaxTreeDepth) + " is needed");
}

}  // namespace prefilter
