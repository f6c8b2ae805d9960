// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/sampling/texel_plan.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace prefilter {
namespace {

/// A table whose samples read texels at this offset below and above the cell's low corner, in a
/// level that is `finer` levels finer, and the cell itself.
SamplingTable reaching_table(int finer, int offset) {
  SamplingTable table;
  table.shape = {"tent", 2, 1, 1, 1};
  for (int levels = 1; levels <= 3; ++levels) {
    TableSection& section = table.sections[3 - levels];
    section.levels = levels;
    section.slices = 1;
    section.texels = {{std::min(finer, levels - 1), offset, 0}, {0, 0, 0}};
    section.coefficients = {0.5, 0, 0, 0, 0.5, 0, 0, 0};
    section.errors = section.trilinear_errors = {0.0};
  }
  return table;
}

/// Sides of levels, each half of the one before, rounded down or up according to the bits of
/// `turns`.
std::vector<int> sides(int side, unsigned turns) {
  std::vector<int> found{side};
  for (; side > 1; turns >>= 1U) {
    side = turns % 2 == 0 ? side / 2 : side / 2 + side % 2;
    found.push_back(side);
  }
  return found;
}

TEST(TexelPlan, KnowsWhichCellsReadNothingBeyondAnEdge) {
  int cells_inside = 0;
  for (int finer = 0; finer < 3; ++finer) {
    for (int offset = -7; offset <= 0; ++offset) {
      const SamplingTable table = reaching_table(finer, offset);
      for (int side = 1; side < 64; ++side) {
        for (unsigned turns = 0; turns < 8; ++turns) {
          std::vector<PyramidLevel> levels;
          for (const int one : sides(side, turns)) levels.push_back({nullptr, one, one});
          const Pyramid pyramid(levels, 1, false);
          const TexelPlan plan(pyramid, table);
          for (std::size_t level = 0; level < pyramid.levels.size(); ++level) {
            const PlannedCells& cells = plan.cells()[level];
            const int below = std::min(finer, cells.available - 1);
            const int last = pyramid.levels[level - static_cast<std::size_t>(below)].width - 1;
            for (double cell = cells.low[0]; cell <= cells.high[0]; ++cell) {
              ++cells_inside;
              for (const double in_cell : {0.0, 0.3, 0.6, 0.999}) {
                const double u = (cell + in_cell) / cells.extents[0][0];
                const Pair corner =
                    cells.corner(below, Pair{u, u}, Pair{cell, cell}, Pair{in_cell, in_cell});
                ASSERT_GE(corner[0] + offset, 0) << side << ", " << level << ", " << cell;
                ASSERT_LE(corner[0] + (1 << below) - 1 - offset, last)
                    << side << ", " << level << ", " << cell;
              }
            }
          }
        }
      }
    }
  }
  EXPECT_GT(cells_inside, 100000);
}

}  // namespace
}  // namespace prefilter
