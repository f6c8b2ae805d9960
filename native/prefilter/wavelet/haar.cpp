// SPDX-License-Identifier: GPL-3.0-or-later

// Synthesis: evaluates equation 3.4 cell by cell from the root down, in place of the coefficients.
#include "prefilter/wavelet/haar.h"

#include <algorithm>
#include <cmath>

#include "prefilter/base/parallel.h"

namespace prefilter {
namespace {
constexpr float kHaarRounding = 1e-5F;

// Snaps values to integers within rounding errors: cells away from the boundary have integer
// values.
float without_rounding(float value) {
  const float whole = std::rint(value);
  return std::abs(value - whole) <= kHaarRounding ? whole : value;
}

// Converts coefficients to values. On the last level all cells are leaves, and clamped.
void to_values(bool is_last, std::size_t begin, std::size_t end, TreeLevel* level) {
  for (std::size_t b = begin; b < end; ++b) {
    OctantValues& values = level->blocks[b];
    hadamard(&values);
    const unsigned met = level->split[b];
    for (int o = 0; o < 8; ++o) {
      const bool is_met = ((met >> o) & 1U) != 0U;
      if (!is_met) values[o] = without_rounding(values[o]);
      if (!is_met || is_last) values[o] = std::clamp(values[o], 0.0F, 1.0F);
    }
    if (is_last) level->split[b] = 0;
  }
}

void pass_down(const TreeLevel& level, std::size_t begin, std::size_t end, TreeLevel* next) {
  for (std::size_t b = begin; b < end; ++b) {
    std::size_t child = level.first[b];
    for (unsigned bits = level.split[b]; bits != 0U; bits &= bits - 1U) {
      next->blocks[child++][0] = level.blocks[b][std::countr_zero(bits)];
    }
  }
}

}  // namespace

CellTree synthesise(HaarTree coefficients, int depth, const Run& run) {
  CellTree tree;
  tree.root = static_cast<float>(coefficients.mean);
  tree.levels = std::move(coefficients.levels);
  if (depth >= 0 && depth < tree.depth()) tree.levels.resize(static_cast<std::size_t>(depth));
  if (tree.levels.empty()) {
    tree.root = std::clamp(tree.root, 0.0F, 1.0F);
    return tree;
  }
  // One more step is for the means.
  const auto count = static_cast<double>(tree.levels.size() + 1);
  tree.levels.front().blocks.front()[0] = tree.root;
  for (std::size_t k = 0; k < tree.levels.size(); ++k) {
    TreeLevel& level = tree.levels[k];
    const bool is_last = k + 1 == tree.levels.size();
    if (!is_last) link_blocks(&level);
    const auto part =
        run.part(static_cast<double>(k) / count, (static_cast<double>(k) + 1) / count);
    for_blocks(level, part, [&](std::size_t begin, std::size_t end) {
      to_values(is_last, begin, end, &level);
      if (!is_last) pass_down(level, begin, end, &tree.levels[k + 1]);
    });
  }
  tree.levels.back().first.assign(tree.levels.back().size(), 0U);
  update_means(&tree, run.part((count - 1.0) / count, 1.0));
  return tree;
}

}  // namespace prefilter
