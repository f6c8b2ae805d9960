#include "prefilter/contour/contour_tree.h"

namespace prefilter {
namespace {
unsigned union_of(std::uint16_t of_block) {
  unsigned sides = of_block;
  sides |= sides >> 8U;
  sides |= sides >> 4U;
  sides |= sides >> 2U;
  return sides & kBothSides;
}
}  // namespace

ContourTree::ContourTree(const CellTree& cells, float isovalue, int threads)
    : cells_(cells), isovalue_(isovalue), sides_(cells.levels.size()) {
  const auto side_of = [&](float value) { return value >= isovalue ? kInside : kOutside; };
  root_sides_ = side_of(cells.root);
  for (std::size_t k = cells.levels.size(); k-- > 0;) {
    const TreeLevel& level = cells.levels[k];
    std::vector<std::uint16_t>& sides = sides_[k];
    sides.resize(level.size());
    for_blocks(level, threads, Progress(), [&](std::size_t begin, std::size_t end) {
      for (std::size_t b = begin; b < end; ++b) {
        unsigned of_block = 0;
        for (int o = 0; o < 8; ++o) {
          const unsigned of_octant = level.is_split(b, o)
                                         ? union_of(sides_[k + 1][level.child(b, o)])
                                         : side_of(level.blocks[b][static_cast<std::size_t>(o)]);
          of_block |= of_octant << (2 * o);
        }
        sides[b] = static_cast<std::uint16_t>(of_block);
      }
    });
  }
  if (!sides_.empty()) root_sides_ = union_of(sides_[0][0]);
}

}  // namespace prefilter
