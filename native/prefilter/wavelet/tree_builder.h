// SPDX-License-Identifier: GPL-3.0-or-later

// Builds trees cell by cell, in parallel.
#pragma once

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

#include "prefilter/base/parallel.h"
#include "prefilter/wavelet/cell_tree.h"

namespace prefilter {

/// The result for a cell.
struct BuiltCell {
  float value = 0.0F;
  bool is_split = false;  // its block was appended last to the level of its depth
};

using TreeLevels = std::vector<TreeLevel>;

/// Appends the block of a cell, then the blocks of its octants, which build_octant(o) builds.
template <typename BuildOctant>
BuiltCell build_block(int depth, TreeLevels* levels, const BuildOctant& build_octant) {
  TreeLevel& level = (*levels)[static_cast<std::size_t>(depth)];
  const std::size_t block = level.size();
  level.blocks.emplace_back();
  level.split.push_back(0);
  for (int o = 0; o < 8; ++o) {
    const BuiltCell octant = build_octant(o);
    level.blocks[block][static_cast<std::size_t>(o)] = octant.value;
    if (octant.is_split) level.split[block] |= static_cast<std::uint8_t>(1U << o);
  }
  return {block_mean(level.blocks[block]), true};
}

/// Builds a tree from any kind of root cell, using `is_split(cell, depth)`, `value(cell, depth)`
/// for leaves, and `octant(cell, depth, o)` for split cells. Throws Error(kCancelled).
template <typename Cell, typename Rule>
CellTree build_tree(const Cell& root, int most_depth, const Rule& rule, const Run& run) {
  constexpr int kTaskDepth = 3;
  struct Task {
    Cell cell;
    BuiltCell built;
    TreeLevels levels;
  };
  const auto build = [&](const auto& self, const Cell& cell, int depth,
                         TreeLevels* levels) -> BuiltCell {
    if (!rule.is_split(cell, depth)) return {rule.value(cell, depth), false};
    return build_block(depth, levels, [&](int o) {
      return self(self, rule.octant(cell, depth, o), depth + 1, levels);
    });
  };
  // Visits the cells above the tasks twice: to create the tasks, and to collect their results.
  std::vector<Task> tasks;
  const auto find = [&](const auto& self, const Cell& cell, int depth) -> void {
    if (!rule.is_split(cell, depth)) return;
    if (depth == kTaskDepth) {
      tasks.push_back({cell, {}, {}});
      return;
    }
    for (int o = 0; o < 8; ++o) self(self, rule.octant(cell, depth, o), depth + 1);
  };
  find(find, root, 0);
  const Stages stages(run, {16, 3, 1});
  parallel_for(static_cast<std::int64_t>(tasks.size()), stages[0], [&](std::int64_t i) {
    Task& task = tasks[static_cast<std::size_t>(i)];
    task.levels.resize(static_cast<std::size_t>(most_depth));
    task.built = build(build, task.cell, kTaskDepth, &task.levels);
  });
  TreeLevels levels(static_cast<std::size_t>(most_depth));
  const Run gathering = stages[1];
  std::size_t next_task = 0;
  const auto gather = [&](const auto& self, const Cell& cell, int depth) -> BuiltCell {
    if (!rule.is_split(cell, depth)) return {rule.value(cell, depth), false};
    if (depth == kTaskDepth) {
      Task& task = tasks[next_task++];
      for (std::size_t k = 0; k < levels.size(); ++k) {
        TreeLevel& from = task.levels[k];
        levels[k].blocks.insert(levels[k].blocks.end(), from.blocks.begin(), from.blocks.end());
        levels[k].split.insert(levels[k].split.end(), from.split.begin(), from.split.end());
        from = TreeLevel();
      }
      gathering.report(static_cast<double>(next_task) / static_cast<double>(tasks.size()));
      return task.built;
    }
    return build_block(depth, &levels,
                       [&](int o) { return self(self, rule.octant(cell, depth, o), depth + 1); });
  };
  CellTree tree;
  tree.root = gather(gather, root, 0).value;
  while (!levels.empty() && levels.back().size() == 0) levels.pop_back();
  tree.levels = std::move(levels);
  for (TreeLevel& level : tree.levels) link_blocks(&level);
  update_means(&tree, stages[2]);
  return tree;
}

}  // namespace prefilter
