// SPDX-License-Identifier: GPL-3.0-or-later

// Visits blocks from the root down, along with the cells around them.
#include "prefilter/wavelet/smooth.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace prefilter {
namespace {

// A cell of some depth, or the larger leaf that contains it.
struct SmoothCell {
  float value = 0.0F;
  std::uint32_t block = 0;  // its octants, if it is split
  bool is_split = false;
};

// The octants of a block and the cells around them, x fastest.
using Around = std::array<SmoothCell, 64>;

constexpr std::size_t at(std::size_t x, std::size_t y, std::size_t z) {
  return (z * 4 + y) * 4 + x;
}

class Smoother {
 public:
  explicit Smoother(const CellTree& tree) : tree_(tree) {
    for (const TreeLevel& level : tree.levels) smoothed_.push_back(level.blocks);
  }

  void visit(std::size_t level, std::size_t block, const Around& around) {
    const TreeLevel& blocks = tree_.levels[level];
    const OctantValues values = convolved(around);
    for (std::size_t o = 0; o < 8; ++o) {
      if (!blocks.is_split(block, static_cast<int>(o))) {
        smoothed_[level][block][o] = values[o];
        continue;
      }
      const std::size_t x = 1 + (o & 1);
      const std::size_t y = 1 + ((o >> 1) & 1);
      const std::size_t z = 1 + (o >> 2);
      visit(level + 1, around[at(x, y, z)].block, octants_around(level + 1, around, x, y, z));
    }
  }

  SmoothCell octant(std::size_t level, const SmoothCell& cell, std::size_t o) const {
    if (!cell.is_split) return cell;
    const TreeLevel& blocks = tree_.levels[level];
    SmoothCell result;
    result.value = blocks.blocks[cell.block][o];
    result.is_split = blocks.is_split(cell.block, static_cast<int>(o));
    if (result.is_split) {
      result.block = static_cast<std::uint32_t>(blocks.child(cell.block, static_cast<int>(o)));
    }
    return result;
  }

  std::vector<std::vector<OctantValues>> take() { return std::move(smoothed_); }

 private:
  // The neighborhood of one cell's octants; along an axis, cell i has the octants 2 i and 2 i + 1.
  Around octants_around(std::size_t level, const Around& around, std::size_t x, std::size_t y,
                        std::size_t z) const {
    Around result;
    for (std::size_t k = 0; k < 4; ++k) {
      for (std::size_t j = 0; j < 4; ++j) {
        for (std::size_t i = 0; i < 4; ++i) {
          const std::size_t u = 2 * x + i - 1;
          const std::size_t v = 2 * y + j - 1;
          const std::size_t w = 2 * z + k - 1;
          result[at(i, j, k)] =
              octant(level, around[at(u / 2, v / 2, w / 2)], (u & 1) + 2 * (v & 1) + 4 * (w & 1));
        }
      }
    }
    return result;
  }

  static OctantValues convolved(const Around& around) {
    const auto mean = [](float low, float middle, float high) {
      return 0.25F * (low + high) + 0.5F * middle;
    };
    std::array<std::array<float, 16>, 2> along_z;  // [z][y, x]
    for (std::size_t z = 0; z < 2; ++z) {
      for (std::size_t i = 0; i < 16; ++i) {
        along_z[z][i] = mean(around[16 * z + i].value, around[16 * (z + 1) + i].value,
                             around[16 * (z + 2) + i].value);
      }
    }
    OctantValues result;
    for (std::size_t o = 0; o < 8; ++o) {
      const std::array<float, 16>& plane = along_z[o >> 2];
      const std::size_t y = (o >> 1) & 1;
      const std::size_t x = o & 1;
      std::array<float, 3> along_y;
      for (std::size_t i = 0; i < 3; ++i) {
        along_y[i] =
            mean(plane[4 * y + x + i], plane[4 * (y + 1) + x + i], plane[4 * (y + 2) + x + i]);
      }
      result[o] = mean(along_y[0], along_y[1], along_y[2]);
    }
    return result;
  }

  const CellTree& tree_;
  std::vector<std::vector<OctantValues>> smoothed_;
};

}  // namespace

void smooth_leaves(CellTree* tree) {
  if (tree->levels.empty()) return;
  Smoother smoother(*tree);
  const SmoothCell root = {tree->root, 0, true};
  Around around;
  for (std::size_t o = 0; o < 8; ++o) {
    around[at(1 + (o & 1), 1 + ((o >> 1) & 1), 1 + (o >> 2))] = smoother.octant(0, root, o);
  }
  smoother.visit(0, 0, around);
  std::vector<std::vector<OctantValues>> smoothed = smoother.take();
  for (std::size_t k = 0; k < tree->levels.size(); ++k) {
    tree->levels[k].blocks = std::move(smoothed[k]);
  }
}

}  // namespace prefilter
