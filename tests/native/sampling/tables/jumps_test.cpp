// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/sampling/jumps.h"

#include <gtest/gtest.h>

namespace prefilter {
namespace {

// Every sample is the texel of its cell.
SamplingTable nearest_texel(const TableShape& shape) {
  SamplingTable table;
  table.shape = shape;
  for (int levels = 1; levels <= 3; ++levels) {
    TableSection& section = table.sections[3 - levels];
    section.levels = levels;
    section.slices = levels == 1 ? 1 : shape.slices;
    const int subdomains = section.slices * shape.subdomains_of_slice();
    section.texels.resize(subdomains * shape.texels);
    section.coefficients.resize(subdomains * shape.texels * shape.terms());
    for (int i = 0; i < subdomains; ++i) {
      section.coefficients[i * shape.texels * shape.terms()] = 1.0;
    }
  }
  return table;
}

TEST(LargestJump, NearestTexelJumpsToItsNeighbor) {
  for (const int grid : {1, 2, 3, 4}) {
    for (const int degree : {1, 2}) {
      // Adjacent boxes do not overlap.
      const SamplingTable box = nearest_texel({"box", 2, grid, 2, degree});
      for (int levels = 1; levels <= 3; ++levels) EXPECT_NEAR(largest_jump(box, levels), 1, 1e-12);
      // The positive part of the difference between adjacent tents integrates to 3/4, and to less
      // between tents of adjacent levels. In the image the latter are single texels.
      const SamplingTable tent = nearest_texel({"tent", 2, grid, 2, degree});
      EXPECT_NEAR(largest_jump(tent, 3), 0.75, 1e-3);
      EXPECT_NEAR(largest_jump(tent, 1), 1.0, 1e-12);
    }
  }
}

}  // namespace
}  // namespace prefilter
