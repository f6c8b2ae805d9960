#include "prefilter/contour/contour_tree.h"

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

ContourTree::ContourTree(const CellTree& cells, float isovalue, int threads)
    : cells_(cells), isovalue_(isovalue), blocks_(cells.levels.size()) {
  const auto side_of = [&](float value) { return value >= isovalue ? kInside : kOutside; };
  root_sides_ = side_of(cells.root);
  for (std::size_t k = cells.levels.size(); k-- > 0;) {
    const TreeLevel& level = cells.levels[k];
    blocks_[k].resize(level.size());
    for_blocks(level, threads, Progress(), [&](std::size_t begin, std::size_t end) {
      for (std::size_t b = begin; b < end; ++b) {
        unsigned sides = 0;
        for (int o = 0; o < 8; ++o) {
          const unsigned of_octant = level.is_split(b, o)
                                         ? union_of(blocks_[k + 1][level.child(b, o)].sides)
                                         : side_of(level.blocks[b][static_cast<std::size_t>(o)]);
          sides |= of_octant << (2 * o);
        }
        blocks_[k][b] = {level.first[b], static_cast<std::uint16_t>(sides), level.split[b]};
      }
    });
  }
  if (!blocks_.empty()) root_sides_ = union_of(blocks_[0][0].sides);
}

}  // namespace prefilter
