// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/wavelet/cell_tree.h"

#include "prefilter/base/parallel.h"

namespace prefilter {
namespace {
constexpr std::int64_t kBlocksPerTask = 1 << 12;

// Sets the means of split cells from the clamped values of their octants.
void pass_up(const TreeLevel& next, std::size_t begin, std::size_t end, TreeLevel* level) {
  for (std::size_t b = begin; b < end; ++b) {
    std::size_t child = level->first[b];
    for (unsigned bits = level->split[b]; bits != 0U; bits &= bits - 1U) {
      level->blocks[b][std::countr_zero(bits)] = block_mean(next.blocks[child++]);
    }
  }
}
}  // namespace

float block_mean(const OctantValues& v) {
  return (((v[0] + v[1]) + (v[2] + v[3])) + ((v[4] + v[5]) + (v[6] + v[7]))) / 8.0F;
}

void link_blocks(TreeLevel* level) {
  level->first.resize(level->size());
  std::uint32_t next = 0;
  for (std::size_t b = 0; b < level->size(); ++b) {
    level->first[b] = next;
    next += static_cast<std::uint32_t>(std::popcount(level->split[b]));
  }
}

void for_blocks(const TreeLevel& level, const Run& run,
                const std::function<void(std::size_t, std::size_t)>& body) {
  parallel_ranges(static_cast<std::int64_t>(level.size()), kBlocksPerTask, run,
                  [&](std::int64_t begin, std::int64_t end) {
                    body(static_cast<std::size_t>(begin), static_cast<std::size_t>(end));
                  });
}

void update_means(CellTree* tree, const Run& run) {
  if (tree->levels.empty()) return;
  const auto steps = static_cast<double>(tree->levels.size() - 1);
  double done = 0.0;
  for (std::size_t k = tree->levels.size() - 1; k-- > 0; ++done) {
    TreeLevel& level = tree->levels[k];
    const Run part = run.part(done / steps, (done + 1.0) / steps);
    for_blocks(level, part, [&](std::size_t begin, std::size_t end) {
      pass_up(tree->levels[k + 1], begin, end, &level);
    });
  }
  tree->root = block_mean(tree->levels.front().blocks.front());
}

}  // namespace prefilter
