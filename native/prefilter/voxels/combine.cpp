// SPDX-License-Identifier: GPL-3.0-or-later

// Boolean operations by traversing two octrees together (D. Meagher, Geometric modeling using
// octree encoding, 1982).
#include "prefilter/voxels/combine.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "prefilter/base/elementary.h"
#include "prefilter/base/error.h"
#include "prefilter/base/parallel.h"
#include "prefilter/voxels/regrid.h"
#include "prefilter/wavelet/leaf_surface.h"
#include "prefilter/wavelet/refine.h"

namespace prefilter {
namespace {

constexpr float kCombineHalf = 0.5F;
// Values within this distance of 1/2, where two surfaces share a cell, are moved this far from it.
constexpr float kTieDistance = 1e-4F;
// Depth of the cells that are distributed among threads.
constexpr int kTaskDepth = 2;

class ValueRule {
 public:
  explicit ValueRule(SetOperation operation) : operation_(operation) {}

  float operator()(float a, float b) const {
    const bool is_shared = is_fraction(a) && is_fraction(b);
    switch (operation_) {
      case SetOperation::kUnion: {
        const float value = std::max(a, b);
        return is_shared && std::abs(value - kCombineHalf) <= kTieDistance
                   ? kCombineHalf + kTieDistance
                   : value;
      }
      case SetOperation::kIntersection:
        return without_film(std::min(a, b), is_shared);
      case SetOperation::kDifference:
        break;
    }
    return without_film(std::min(a, 1.0F - b), is_shared);
  }

  /// Whether the result does not depend on the other shape.
  bool is_settled_by_a(float a) const {
    return operation_ == SetOperation::kUnion ? a >= 1.0F : a <= 0.0F;
  }
  bool is_settled_by_b(float b) const {
    return operation_ == SetOperation::kIntersection ? b <= 0.0F : b >= 1.0F;
  }

 private:
  static float without_film(float value, bool is_shared) {
    return is_shared && std::abs(value - kCombineHalf) <= kTieDistance ? kCombineHalf - kTieDistance
                                                                       : value;
  }
  SetOperation operation_;
};

// A cell of a tree: split, with a block at the level of its depth, or uniform.
struct Cell {
  const CellTree* tree;
  bool is_split;
  std::size_t block;
  float value;

  static Cell root_of(const CellTree& tree) { return {&tree, !tree.levels.empty(), 0, tree.root}; }

  Cell octant(int depth, int o) const {
    if (!is_split) return *this;
    const TreeLevel& level = tree->levels[static_cast<std::size_t>(depth)];
    const bool splits = level.is_split(block, o);
    return {tree, splits, splits ? level.child(block, o) : 0, level.blocks[block][o]};
  }

  /// Whether its octants are leaves: the surface passes through them.
  bool is_finest(int depth) const {
    return is_split && tree->levels[static_cast<std::size_t>(depth)].split[block] == 0U;
  }
};

// The result for a cell.
struct MergedCell {
  float value = 0.0F;
  bool is_split = false;  // its block was appended last to the level of its depth
};

using Levels = std::vector<TreeLevel>;

// Traverses both trees simultaneously, in the order of the result's blocks.
class Merger {
 public:
  explicit Merger(SetOperation operation) : rule_(operation) {}

  MergedCell merge(const Cell& a, const Cell& b, int depth, Levels* levels) const {
    return merge_with(a, b, depth, levels,
                      [&](const Cell& of_a, const Cell& of_b, int octant_depth) {
                        return merge(of_a, of_b, octant_depth, levels);
                      });
  }

  template <typename MergeOctant>
  MergedCell merge_with(const Cell& a, const Cell& b, int depth, Levels* levels,
                        const MergeOctant& merge_octant) const {
    if (!a.is_split && (!b.is_split || rule_.is_settled_by_a(a.value))) {
      return {rule_(a.value, b.value), false};
    }
    if (!b.is_split && rule_.is_settled_by_b(b.value)) return {rule_(a.value, b.value), false};
    TreeLevel& level = (*levels)[static_cast<std::size_t>(depth)];
    const std::size_t block = level.size();
    level.blocks.emplace_back();
    level.split.push_back(0);
    for (int o = 0; o < 8; ++o) {
      const MergedCell octant = merge_octant(a.octant(depth, o), b.octant(depth, o), depth + 1);
      level.blocks[block][static_cast<std::size_t>(o)] = octant.value;
      if (octant.is_split) level.split[block] |= static_cast<std::uint8_t>(1U << o);
    }
    const OctantValues values = level.blocks[block];
    // A surface along cell borders leaves cells uniform, but they must stay fine, as a contour
    // between larger cells would cut corners off.
    const bool is_uniform =
        !a.is_finest(depth) && !b.is_finest(depth) && level.split[block] == 0 &&
        !is_fraction(values[0]) &&
        std::all_of(values.begin(), values.end(), [&](float value) { return value == values[0]; });
    if (is_uniform) {
      level.blocks.pop_back();
      level.split.pop_back();
      return {values[0], false};
    }
    return {block_mean(values), true};
  }

 private:
  ValueRule rule_;
};

struct Task {
  Cell a;
  Cell b;
  MergedCell merged;
  Levels levels;
};

void append(Levels* levels, Levels* from) {
  for (std::size_t k = 0; k < levels->size(); ++k) {
    TreeLevel& level = (*levels)[k];
    level.blocks.insert(level.blocks.end(), (*from)[k].blocks.begin(), (*from)[k].blocks.end());
    level.split.insert(level.split.end(), (*from)[k].split.begin(), (*from)[k].split.end());
    (*from)[k] = TreeLevel();
  }
}

// Combines trees with the same root whose surfaces lie in cells of one size.
CellTree merge_trees(const CellTree& a, const CellTree& b, SetOperation operation, const Run& run) {
  const Merger merger(operation);
  const auto depth = static_cast<std::size_t>(std::max(a.depth(), b.depth()));
  Levels levels(depth);

  // Traverses the cells above the tasks' twice: first to find the tasks, then to collect their
  // results. The tasks are the cells of depth kTaskDepth that are reached, in order.
  std::vector<Task> tasks;
  Levels above(depth);
  const auto find = [&](const auto& self, const Cell& of_a, const Cell& of_b,
                        int at) -> MergedCell {
    if (at == kTaskDepth) {
      tasks.push_back({of_a, of_b, {}, {}});
      return {kCombineHalf, false};
    }
    return merger.merge_with(of_a, of_b, at, &above, [&](const Cell& x, const Cell& y, int next) {
      return self(self, x, y, next);
    });
  };
  const Cell root_a = Cell::root_of(a);
  const Cell root_b = Cell::root_of(b);
  find(find, root_a, root_b, 0);

  const Stages stages(run, {8, 1, 1});
  const Run merging = stages[0];
  parallel_for(static_cast<std::int64_t>(tasks.size()), merging, [&](std::int64_t i) {
    Task& task = tasks[static_cast<std::size_t>(i)];
    task.levels.resize(depth);
    task.merged = merger.merge(task.a, task.b, kTaskDepth, &task.levels);
  });

  const Run gathering = stages[1];
  std::size_t next_task = 0;
  const auto gather = [&](const auto& self, const Cell& of_a, const Cell& of_b,
                          int at) -> MergedCell {
    if (at == kTaskDepth) {
      Task& task = tasks[next_task++];
      append(&levels, &task.levels);
      gathering.report(static_cast<double>(next_task) / static_cast<double>(tasks.size()));
      return task.merged;
    }
    return merger.merge_with(of_a, of_b, at, &levels, [&](const Cell& x, const Cell& y, int next) {
      return self(self, x, y, next);
    });
  };
  CellTree tree;
  tree.root = gather(gather, root_a, root_b, 0).value;
  while (!levels.empty() && levels.back().size() == 0) levels.pop_back();
  tree.levels = std::move(levels);
  for (TreeLevel& level : tree.levels) link_blocks(&level);
  update_means(&tree, stages[2]);
  // All cells are empty, or all are full.
  if (!is_fraction(tree.root)) tree.levels.clear();
  return tree;
}

// Refines both trees first: contours of surfaces in cells of different sizes could self-intersect.
CellTree combine_trees(const CellTree& a, const CellTree& b, SetOperation operation,
                       const Run& run) {
  const int depth = std::max(a.depth(), b.depth());
  CellTree fine_a;
  CellTree fine_b;
  const auto fine = [&](const CellTree& tree, const Run& part,
                        CellTree* result) -> const CellTree& {
    if (tree.depth() == depth && !has_coarse_surface(tree)) return tree;
    *result = refined(tree, depth, part);
    return *result;
  };
  const Stages stages(run, {3, 3, 4});
  const CellTree& first = fine(a, stages[0], &fine_a);
  const CellTree& second = fine(b, stages[1], &fine_b);
  return merge_trees(first, second, operation, stages[2]);
}

bool same_box(const Box& a, const Box& b) {
  for (int i = 0; i < 3; ++i) {
    const double slack = 1e-12 * a.size(i);
    if (std::abs(a.low[i] - b.low[i]) > slack || std::abs(a.high[i] - b.high[i]) > slack) {
      return false;
    }
  }
  return true;
}

// Union of the thickened cells.
CellTree united_thickened(const Octree& a, const Octree& b, int threads) {
  if (a.thickened.levels.empty()) return b.thickened;
  if (b.thickened.levels.empty()) return a.thickened;
  return merge_trees(a.thickened, b.thickened, SetOperation::kUnion, Run(threads));
}

// The first depth at which cells of the root are no larger, along any axis, than the octree's
// finest.
int matching_depth(const Box& root, const Octree& octree) {
  int depth = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const double ratio = root.size(axis) / octree.cell_size(axis, octree.cells.depth());
    depth = std::max(depth, static_cast<int>(std::ceil(elementary::log2(ratio) - 1e-6)));
  }
  return std::min(depth, kMaxTreeDepth);
}
}  // namespace

Octree combine(const Octree& a, const Octree& b, SetOperation operation, const Run& run) {
  Octree result;
  if (same_box(a.bounds, b.bounds)) {
    result.bounds = a.bounds;
    result.depth = std::max(a.depth, b.depth);
    result.cells = combine_trees(a.cells, b.cells, operation, run);
    result.thickened = united_thickened(a, b, run.threads());
    run.report(1.0);
    return result;
  }
  std::optional<Octree> larger;
  if (operation == SetOperation::kUnion) {
    const std::optional<Box> occupied = occupied_box(b);
    if (occupied && !holds(a.bounds, *occupied)) larger = grown(a, *occupied);
  }
  const Octree& first = larger ? *larger : a;
  const int depth = std::max(matching_depth(first.bounds, b), first.cells.depth());
  const Stages stages(run, {7, 3});
  const Octree second = regridded(b, first.bounds, depth, stages[0]);
  result.bounds = first.bounds;
  result.depth = std::max(first.depth, depth);
  result.cells = combine_trees(first.cells, second.cells, operation, stages[1]);
  run.report(1.0);
  return result;
}

}  // namespace prefilter
