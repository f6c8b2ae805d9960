// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/images/resize/bilinear_fit.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "geometry/texels/scenes.h"

namespace prefilter {
namespace {

// The nonzero tents at a position on an axis: their texels and values.
struct Tents {
  int texels[2];
  double shares[2];
};

Tents tents_at(double u, int size, Wrap wrap) {
  const double x = u * size - 0.5;
  const double first = std::floor(x);
  Tents tents{{static_cast<int>(first), static_cast<int>(first) + 1}, {first + 1.0 - x, x - first}};
  for (int& texel : tents.texels) texel = wrap_index(texel, size, wrap);
  return tents;
}

// The residual of least squares is orthogonal to each tent: the integral of the difference between
// the fit and the boxes of the source, times the tent, is 0.
TEST(BilinearFit, ResidualIsOrthogonalToTheTents) {
  for (const Wrap wrap : {Wrap::kClamp, Wrap::kRepeat, Wrap::kBorder}) {
    for (const auto& [width, height] : {std::pair(3, 2), std::pair(5, 4), std::pair(12, 9)}) {
      const Image source = testing::random_image(3, 11, 7, 1);
      SolveOptions solve;
      solve.tolerance = 1e-7;
      solve.max_sweeps = 5000;
      constexpr float kInfinity = std::numeric_limits<float>::infinity();
      for (ValueRange& range : solve.ranges) range = {-kInfinity, kInfinity};
      const Image fit = fit_bilinearly(source.view(), width, height, {wrap, wrap}, solve, nullptr,
                                       prefilter::Run());
      std::vector<double> left(static_cast<std::size_t>(width) * height);
      // Centers between all lines of both grids: 11 * 12 * 5 * 2 and 7 * 9 * 4 * 2 steps.
      constexpr int kColumns = 1320;
      constexpr int kRows = 504;
      for (int row = 0; row < kRows; ++row) {
        const double v = (row + 0.5) / kRows;
        const Tents along_y = tents_at(v, height, wrap);
        for (int column = 0; column < kColumns; ++column) {
          const double u = (column + 0.5) / kColumns;
          const Tents along_x = tents_at(u, width, wrap);
          double off = -*source.texel(static_cast<int>(u * 11), static_cast<int>(v * 7));
          for (int k = 0; k < 4; ++k) {
            const int x = along_x.texels[k % 2];
            const int y = along_y.texels[k / 2];
            if (x < 0 || y < 0) continue;
            off += along_x.shares[k % 2] * along_y.shares[k / 2] * *fit.texel(x, y);
          }
          for (int k = 0; k < 4; ++k) {
            const int x = along_x.texels[k % 2];
            const int y = along_y.texels[k / 2];
            if (x < 0 || y < 0) continue;
            left[static_cast<std::size_t>(y) * width + x] +=
                off * along_x.shares[k % 2] * along_y.shares[k / 2];
          }
        }
      }
      const double texel = static_cast<double>(kColumns) * kRows / width / height;
      for (const double value : left) EXPECT_NEAR(value / texel, 0.0, 1e-3);
    }
  }
}

}  // namespace
}  // namespace prefilter
