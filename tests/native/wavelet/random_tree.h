// SPDX-License-Identifier: GPL-3.0-or-later

// Random trees with leaves of all depths and arbitrary values.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <random>
#include <utility>

#include "prefilter/wavelet/cell_tree.h"

namespace prefilter {

inline CellTree random_tree(unsigned seed, int depth) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> uniform(0.0F, 1.0F);
  CellTree tree;
  std::size_t blocks = 1;
  for (int k = 0; k < depth && blocks > 0; ++k) {
    TreeLevel level;
    level.blocks.resize(blocks);
    blocks = 0;
    for (OctantValues& block : level.blocks) {
      std::uint8_t split = 0;
      for (std::size_t o = 0; o < 8; ++o) {
        const float draw = uniform(random);
        block[o] = draw < 0.3F ? 0.0F : draw > 0.7F ? 1.0F : uniform(random);
        if (k + 1 < depth && uniform(random) < 0.4F) split |= static_cast<std::uint8_t>(1U << o);
      }
      level.split.push_back(split);
      blocks += static_cast<std::size_t>(std::popcount(split));
    }
    link_blocks(&level);
    tree.levels.push_back(std::move(level));
  }
  update_means(&tree, prefilter::Run(1));
  return tree;
}

}  // namespace prefilter
