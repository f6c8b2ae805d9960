// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/voxels/contour/contour_tree.h"

namespace prefilter {
namespace {
std::uint8_t union_of(std::uint16_t of_block) {
  unsigned sides = of_block;
  sides |= sides >> 8U;
  sides |= sides >> 4U;
  sides |= sides >> 2U;
  return static_cast<std::uint8_t>(sides & kBothSides);
}
}  // namespace

ContourTree::ContourTree(const CellTree& cells, float isovalue, const Run& run)
    : cells_(cells), isovalue_(isovalue), blocks_(cells.levels.size()) {
  const auto side_of = [&](float value) { return value >= isovalue ? kInside : kOutside; };
  root_sides_ = side_of(cells.root);
  const auto steps = static_cast<double>(cells.levels.size() + 1);
  for (std::size_t k = 0; k < cells.levels.size(); ++k) {
    const TreeLevel& level = cells.levels[k];
    blocks_[k].resize(level.size());
    const auto step = static_cast<double>(k);
    const Run part = run.part(step / steps, (step + 1.0) / steps);
    for_blocks(level, part, [&](std::size_t begin, std::size_t end) {
      for (std::size_t b = begin; b < end; ++b) {
        unsigned sides = 0;
        for (int o = 0; o < 8; ++o) {
          const unsigned side = side_of(level.blocks[b][static_cast<std::size_t>(o)]);
          sides |= side << (2 * o);
        }
        blocks_[k][b] = {level.first[b], static_cast<std::uint16_t>(sides), level.split[b]};
      }
    });
  }
  update_sides(run.part((steps - 1.0) / steps, 1.0));
}

void ContourTree::update_sides(const Run& run) {
  if (blocks_.empty()) return;
  const auto steps = static_cast<double>(blocks_.size() - 1);
  double done = 0.0;
  for (std::size_t k = blocks_.size() - 1; k-- > 0; ++done) {
    const TreeLevel& level = cells_.levels[k];
    const Run part = run.part(done / steps, (done + 1.0) / steps);
    for_blocks(level, part, [&](std::size_t begin, std::size_t end) {
      for (std::size_t b = begin; b < end; ++b) {
        std::size_t child = level.first[b];
        for (unsigned bits = level.split[b]; bits != 0U; bits &= bits - 1U) {
          set_side(k, b, std::countr_zero(bits), union_of(blocks_[k + 1][child++].sides));
        }
      }
    });
  }
  root_sides_ = union_of(blocks_[0][0].sides);
}

CellTree split_root(float value) {
  CellTree split;
  split.root = value;
  split.levels.resize(1);
  split.levels[0].blocks.emplace_back();
  split.levels[0].blocks[0].fill(value);
  split.levels[0].split.push_back(0);
  link_blocks(split.levels.data());
  return split;
}

}  // namespace prefilter
