// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/voxels/grid_contour.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

#include "prefilter/base/parallel.h"
#include "prefilter/voxels/contour/contour_tree.h"
#include "prefilter/voxels/contour/fit_vertices.h"
#include "prefilter/voxels/contour/samples.h"
#include "prefilter/voxels/tree_contour.h"

namespace prefilter {
namespace {

constexpr int kGridContourTaskDepth = 3;

using CellCoordinates = std::array<int, 3>;
using Levels = std::vector<TreeLevel>;

// Sides of the iso-value on which the samples of each block of 2 x 2 x 2 lie; the outside of the
// grid is empty.
class BlockSides {
 public:
  BlockSides(const GridView& grid, const ContourOptions& options, const Run& run)
      : grid_(grid), least_inside_(options.isovalue), most_outside_(options.isovalue) {
    if (options.interpolant == Interpolant::kPlane && options.isovalue == 0.5F) {
      // settle_sides may assign these to either side.
      least_inside_ -= kDoubt;
      most_outside_ += kDoubt;
    }
    for (std::size_t a = 0; a < 3; ++a) size_[a] = (grid.size[a] + 1) / 2;
    const auto slice = static_cast<std::size_t>(size_[1]) * static_cast<std::size_t>(size_[2]);
    sides_.resize(static_cast<std::size_t>(size_[0]) * slice);
    parallel_for(size_[0], run, [&](std::int64_t x) {
      std::uint8_t* of_slice = sides_.data() + static_cast<std::size_t>(x) * slice;
      const int low = 2 * static_cast<int>(x);
      for (int i = low; i < std::min(low + 2, grid.size[0]); ++i) {
        for (int j = 0; j < grid.size[1]; ++j) {
          const float* row = &grid.values[grid.index(i, j, 0)];
          check_samples({row, static_cast<std::size_t>(grid.size[2])});
          std::uint8_t* of_row = of_slice + static_cast<std::size_t>(j / 2) * size_[2];
          for (int k = 0; k < grid.size[2]; ++k) of_row[k / 2] |= side_of(row[k]);
        }
      }
    });
  }

  /// Whether the surface passes between samples of a block, or between them and adjacent samples.
  bool is_near_surface(const CellCoordinates& block) const {
    unsigned sides = 0;
    for_around(block, 1, [&](int x, int y, int z) {
      const bool is_within =
          x >= 0 && y >= 0 && z >= 0 && x < size_[0] && y < size_[1] && z < size_[2];
      sides |= is_within ? sides_[(static_cast<std::size_t>(x) * size_[1] + y) * size_[2] + z]
                         : kOutside;
    });
    if (sides != kBothSides) return false;
    sides = 0;
    for_around({2 * block[0], 2 * block[1], 2 * block[2]}, 2, [&](int x, int y, int z) {
      const bool is_within =
          x >= 0 && y >= 0 && z >= 0 && x < grid_.size[0] && y < grid_.size[1] && z < grid_.size[2];
      sides |= is_within ? side_of(grid_.at(x, y, z)) : kOutside;
    });
    return sides == kBothSides;
  }

 private:
  std::uint8_t side_of(float sample) const {
    return static_cast<std::uint8_t>((sample >= least_inside_ ? kInside : 0) |
                                     (sample < most_outside_ ? kOutside : 0));
  }

  // Visits positions from one before `low` to one after the `count` that follow.
  template <typename Visit>
  static void for_around(const CellCoordinates& low, int count, const Visit& visit) {
    for (int x = low[0] - 1; x <= low[0] + count; ++x) {
      for (int y = low[1] - 1; y <= low[1] + count; ++y) {
        for (int z = low[2] - 1; z <= low[2] + count; ++z) visit(x, y, z);
      }
    }
  }

  const GridView& grid_;
  float least_inside_;
  float most_outside_;
  CellCoordinates size_{};
  std::vector<std::uint8_t> sides_;
};

struct Built {
  float value = 0.0F;
  bool is_split = false;
};

class TreeBuilder {
 public:
  TreeBuilder(const GridView& grid, const BlockSides& sides, float isovalue, int depth)
      : grid_(grid), sides_(sides), empty_(empty_sample(isovalue)), depth_(depth) {}

  // Builds a cell of a depth; appends its blocks to the levels.
  Built build(const CellCoordinates& cell, int at_depth, Levels* levels) const {
    if (depth_ - at_depth == 1) {
      return build_with(cell, at_depth, levels,
                        [&](const CellCoordinates& octant) { return sample(octant); });
    }
    return build_with(cell, at_depth, levels, [&](const CellCoordinates& octant) {
      return build(octant, at_depth + 1, levels);
    });
  }

  template <typename BuildOctant>
  Built build_with(const CellCoordinates& cell, int at_depth, Levels* levels,
                   const BuildOctant& build_octant) const {
    const int shift = depth_ - at_depth;
    for (int a = 0; a < 3; ++a) {
      if (cell[a] << shift >= grid_.size[a]) return {empty_, false};
    }
    if (shift == 0) return sample(cell);
    OctantValues values;
    unsigned split = 0;
    for (int o = 0; o < 8; ++o) {
      const Built octant = build_octant(
          {2 * cell[0] + (o & 1), 2 * cell[1] + ((o >> 1) & 1), 2 * cell[2] + ((o >> 2) & 1)});
      values[static_cast<std::size_t>(o)] = octant.value;
      if (octant.is_split) split |= 1U << o;
    }
    // Equal samples form one leaf, except near the surface: a vertex lies halfway between two
    // centers, which must be those of the samples.
    if (split == 0 &&
        std::all_of(values.begin(), values.end(),
                    [&](float value) { return value == values[0]; }) &&
        !(shift == 1 && sides_.is_near_surface(cell))) {
      return {values[0], false};
    }
    TreeLevel& level = (*levels)[static_cast<std::size_t>(at_depth)];
    level.blocks.push_back(values);
    level.split.push_back(static_cast<std::uint8_t>(split));
    return {block_mean(values), true};
  }

 private:
  Built sample(const CellCoordinates& at) const {
    const bool is_within = at[0] < grid_.size[0] && at[1] < grid_.size[1] && at[2] < grid_.size[2];
    return {is_within ? grid_.at(at[0], at[1], at[2]) : empty_, false};
  }

  const GridView& grid_;
  const BlockSides& sides_;
  float empty_;
  int depth_;
};

struct Task {
  CellCoordinates cell;
  Built built;
  Levels levels;
};

CellTree tree_of(const GridView& grid, int depth, const ContourOptions& options, const Run& run) {
  const Stages stages(run, {3, 7});
  const BlockSides sides(grid, options, stages[0]);
  const TreeBuilder builder(grid, sides, options.isovalue, depth);
  const int task_depth = std::min(kGridContourTaskDepth, depth);
  const int tasks_along = 1 << task_depth;
  std::vector<Task> tasks(static_cast<std::size_t>(tasks_along * tasks_along * tasks_along));
  const auto task_at = [&](const CellCoordinates& cell) -> Task& {
    return tasks[static_cast<std::size_t>((cell[0] * tasks_along + cell[1]) * tasks_along +
                                          cell[2])];
  };
  const auto count = static_cast<std::int64_t>(tasks.size());
  parallel_for(count, stages[1], [&](std::int64_t i) {
    Task& task = tasks[static_cast<std::size_t>(i)];
    const int index = static_cast<int>(i);
    task.cell = {index / (tasks_along * tasks_along), index / tasks_along % tasks_along,
                 index % tasks_along};
    task.levels.resize(static_cast<std::size_t>(depth));
    task.built = builder.build(task.cell, task_depth, &task.levels);
  });

  Levels levels(static_cast<std::size_t>(depth));
  const auto gather = [&](const auto& self, const CellCoordinates& cell, int at_depth) -> Built {
    if (at_depth == task_depth) {
      Task& task = task_at(cell);
      for (std::size_t k = 0; k < levels.size(); ++k) {
        TreeLevel& from = task.levels[k];
        levels[k].blocks.insert(levels[k].blocks.end(), from.blocks.begin(), from.blocks.end());
        levels[k].split.insert(levels[k].split.end(), from.split.begin(), from.split.end());
        from = TreeLevel();
      }
      return task.built;
    }
    return builder.build_with(cell, at_depth, &levels, [&](const CellCoordinates& octant) {
      return self(self, octant, at_depth + 1);
    });
  };
  CellTree tree;
  tree.root = gather(gather, {0, 0, 0}, 0).value;
  while (!levels.empty() && levels.back().size() == 0) levels.pop_back();
  tree.levels = std::move(levels);
  for (TreeLevel& level : tree.levels) link_blocks(&level);
  return tree;
}

}  // namespace

TriangleMesh contour_grid(const GridView& grid, const GridFrame& frame,
                          const ContourOptions& options) {
  check_sides(grid.size);
  const int longest = std::max({grid.size[0], grid.size[1], grid.size[2]});
  const int depth =
      std::max(1, static_cast<int>(std::bit_width(static_cast<unsigned>(longest - 1))));
  Box root{frame.origin, {}};
  for (int a = 0; a < 3; ++a) {
    root.high[a] = frame.origin[a] + std::ldexp(frame.spacing[a], depth);
  }
  check_box(root, "spacing: the grid");
  ContourOptions rest = options;
  rest.interpolant = options.interpolant.value_or(Interpolant::kOccupancy);
  const Stages stages(options.run, {3, 7});
  const CellTree tree = tree_of(grid, depth, rest, stages[0]);
  rest.run = stages[1];
  return contour_tree(tree, root, rest);
}

}  // namespace prefilter
