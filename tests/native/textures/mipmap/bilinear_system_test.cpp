// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/textures/mipmap/bilinear_system.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "geometry/texels/scenes.h"
#include "prefilter/textures/texels/levels.h"

namespace prefilter {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

// Sums over a dense grid of points of the unit square, which is the surface.
struct Dense {
  std::vector<double> matrix;
  std::vector<double> right;
};

Dense dense_system(const Image& image, int width, int height, WrapModes wrap, int steps) {
  const int count = width * height;
  Dense dense{std::vector<double>(static_cast<std::size_t>(count) * count),
              std::vector<double>(count)};
  const auto taps = [&](double u, double v, int w, int h, int* texels, double* shares) {
    const double x = u * w - 0.5;
    const double y = v * h - 0.5;
    const int x0 = static_cast<int>(std::floor(x));
    const int y0 = static_cast<int>(std::floor(y));
    for (int k = 0; k < 4; ++k) {
      const int i = wrap_index(x0 + k % 2, w, wrap.u);
      const int j = wrap_index(y0 + k / 2, h, wrap.v);
      texels[k] = i < 0 || j < 0 ? -1 : j * w + i;
      shares[k] = std::abs(1 - k % 2 - (x - x0)) * std::abs(1 - k / 2 - (y - y0));
    }
  };
  const double mass = static_cast<double>(image.width) * image.height / steps / steps;
  for (int n = 0; n < steps; ++n) {
    for (int m = 0; m < steps; ++m) {
      const double u = (m + 0.5) / steps;
      const double v = (n + 0.5) / steps;
      int texels[4];
      double shares[4];
      taps(u, v, image.width, image.height, texels, shares);
      double value = 0.0;
      for (int k = 0; k < 4; ++k) {
        if (texels[k] >= 0) value += shares[k] * image.data[texels[k]];
      }
      taps(u, v, width, height, texels, shares);
      for (int k = 0; k < 4; ++k) {
        if (texels[k] < 0) continue;
        dense.right[texels[k]] += mass * shares[k] * value;
        for (int l = 0; l < 4; ++l) {
          if (texels[l] < 0) continue;
          dense.matrix[static_cast<std::size_t>(texels[k]) * count + texels[l]] +=
              mass * shares[k] * shares[l];
        }
      }
    }
  }
  return dense;
}

Surface unit_square() {
  Surface surface = testing::one_triangle({{{0, 0}, {1, 0}, {1, 1}}});
  surface.uvs.push_back({{{0, 0}, {1, 1}, {0, 1}}});
  surface.areas.push_back(1.0);
  return surface;
}

class LevelTest : public ::testing::TestWithParam<std::tuple<Wrap, Wrap, int>> {};

// The normal equations of the unconstrained problem, and the signs of the gradient at the bounds.
TEST_P(LevelTest, MeetsTheOptimalityConditions) {
  const auto [u, v, level] = GetParam();
  const int width = level_size(8, level);
  const int height = width;
  const WrapModes wrap{u, v};
  const Image image = testing::random_image(1, 8, 8, 1);
  const Surface surface = unit_square();
  const TexelTriangles triangles =
      map_to_texels({&surface}, 8, 8, wrap, MassOf::kArea, prefilter::Run(0));
  for (const ValueRange range : {ValueRange{-kInfinity, kInfinity}, ValueRange{0.35F, 0.65F}}) {
    BilinearSystem<1> system(width, height, wrap);
    sweep_moments<1>(triangles, image.view(), wrap, {.first_level = 1, .last_level = level},
                     prefilter::Run(), [&](const MomentBlock<1>& block) {
                       if (block.level == level) system.add(block);
                     });
    const auto solution = system.solve(TargetShares(), {.ranges = {range}, .tolerance = 1e-7},
                                       nullptr, prefilter::Run());
    const Dense dense = dense_system(image, width, height, wrap, 800);
    const int count = width * height;
    double mean_diagonal = 0.0;
    for (int i = 0; i < count; ++i) mean_diagonal += dense.matrix[i * count + i] / count;
    for (int i = 0; i < count; ++i) {
      const double diagonal = dense.matrix[i * count + i];
      double gradient = -dense.right[i];
      for (int j = 0; j < count; ++j) {
        gradient += dense.matrix[i * count + j] * solution.image.data[j];
      }
      const double value = solution.image.data[i];
      // The regularization moves texels by at most this, for values in [0, 1].
      const double slack = 2e-4 + BilinearSystem<1>::kRegularization * mean_diagonal / diagonal;
      if (value > range.low) {
        EXPECT_LT(gradient / diagonal, slack);
      }
      if (value < range.high) {
        EXPECT_GT(gradient / diagonal, -slack);
      }
      EXPECT_GE(value, range.low);
      EXPECT_LE(value, range.high);
      EXPECT_EQ(solution.used[i], 1);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Wraps, LevelTest,
                         ::testing::Values(std::tuple{Wrap::kClamp, Wrap::kClamp, 1},
                                           std::tuple{Wrap::kRepeat, Wrap::kRepeat, 1},
                                           std::tuple{Wrap::kBorder, Wrap::kRepeat, 1},
                                           std::tuple{Wrap::kRepeat, Wrap::kClamp, 2},
                                           std::tuple{Wrap::kRepeat, Wrap::kRepeat, 2},
                                           std::tuple{Wrap::kRepeat, Wrap::kRepeat, 3},
                                           std::tuple{Wrap::kClamp, Wrap::kBorder, 3}));

TEST(BilinearSystemTest, UnreadTexelsAreMarked) {
  const Surface corner = testing::one_triangle({{{0.01, 0.01}, {0.1, 0.01}, {0.01, 0.1}}});
  const Image image = testing::random_image(2, 16, 16, 1);
  const TexelTriangles triangles =
      map_to_texels({&corner}, 16, 16, {}, MassOf::kArea, prefilter::Run(0));
  BilinearSystem<1> system(8, 8, {});
  sweep_moments<1>(triangles, image.view(), {}, {.first_level = 1, .last_level = 1},
                   prefilter::Run(), [&](const MomentBlock<1>& block) { system.add(block); });
  const auto solution =
      system.solve(TargetShares(), {.ranges = {ValueRange{0.0F, 1.0F}}}, nullptr, prefilter::Run());
  // The triangle ends at 0.8 texels, so it reads the first two columns and rows.
  for (int y = 0; y < 8; ++y) {
    for (int x = 0; x < 8; ++x) {
      const bool read = x < 2 && y < 2;
      if (x == 1 && y == 1) continue;  // the slanted side comes only near its tent
      EXPECT_EQ(solution.used[8 * y + x], read ? 1 : 0) << x << " " << y;
    }
  }
}

}  // namespace
}  // namespace prefilter
