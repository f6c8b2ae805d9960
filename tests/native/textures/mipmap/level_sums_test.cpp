// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/textures/mipmap/level_sums.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "geometry/texels/scenes.h"
#include "prefilter/images/transfer.h"

namespace prefilter {
namespace {

constexpr WrapModes kClamped{Wrap::kClamp, Wrap::kClamp};
constexpr int kSize = 8;

// The lower left half of the unit square, of area 1/2 in space.
TexelTriangles half_square() {
  static const Surface surface = testing::one_triangle({{{0.0, 0.0}, {1.0, 0.0}, {0.0, 1.0}}}, 0.5);
  return map_to_texels({&surface}, kSize, kSize, kClamped, MassOf::kArea, prefilter::Run(1));
}

double lookup(const ImageView& image, double u, double v) {
  const double x = u * image.width - 0.5;
  const double y = v * image.height - 0.5;
  const int x0 = static_cast<int>(std::floor(x));
  const int y0 = static_cast<int>(std::floor(y));
  double sum = 0.0;
  for (int k = 0; k < 4; ++k) {
    const int i = std::min(std::max(x0 + k % 2, 0), image.width - 1);
    const int j = std::min(std::max(y0 + k / 2, 0), image.height - 1);
    sum += std::abs(1 - k % 2 - (x - x0)) * std::abs(1 - k / 2 - (y - y0)) * *image.texel(i, j);
  }
  return sum;
}

// The integral of `value` over the triangle, from a fine grid. Sweeps scale the surface's area to
// the number of texels in the image.
template <typename Value>
double integral(const Value& value) {
  constexpr int kSteps = 600;
  double sum = 0.0;
  for (int n = 0; n < kSteps; ++n) {
    for (int m = 0; m + n < kSteps; ++m) {
      const double share = m + n + 1 < kSteps ? 1.0 : 0.5;
      sum += share * value((m + 0.5) / kSteps, (n + 0.5) / kSteps);
    }
  }
  return sum / kSteps / kSteps * 2.0 * kSize * kSize;
}

TEST(LevelSums, SquaresMatchTheReader) {
  const Image image = testing::random_image(3, kSize, kSize, 1);
  const auto sum = [&](const Image& swept, Reader reader, bool has_squares) {
    int blocks = 0;
    const TargetSquares sums =
        sum_image<1>(half_square(), {TexelSource(swept.view()), image.view()}, kClamped, reader,
                     has_squares, 2, prefilter::Run(1), [&](const MomentBlock<1>& block) {
                       EXPECT_GT(block.level, 0);
                       EXPECT_LE(block.level, 2);
                       ++blocks;
                     });
    EXPECT_GT(blocks, 1);
    return sums.image[0];
  };
  const double square = integral([&](double u, double v) {
    const double value = lookup(image.view(), u, v);
    return value * value;
  });
  EXPECT_NEAR(sum(image, Reader::kLinear, true), square, 2e-4 * square);
  EXPECT_EQ(sum(image, Reader::kLinear, false), 0.0);

  const Image encoded = encode_srgb(image.view(), 1);
  const double decoded = integral([&](double u, double v) {
    const double value = srgb_to_linear(static_cast<float>(lookup(encoded.view(), u, v)));
    return value * value;
  });
  EXPECT_NEAR(sum(encoded, Reader::kSrgbAfter, true), decoded, 1e-2 * decoded);
}

// The tent of texel (i, j) among size x size.
Image tent_image(int size, int i, int j) {
  Image one(size, size, 1);
  *one.texel(i, j) = 1.0F;
  return one;
}

// The integral of a level's lookups times a tent of `size` x `size` texels.
double tent_integral(const ImageView& seen, int size, int i, int j) {
  const Image one = tent_image(size, i, j);
  return integral(
      [&](double u, double v) { return lookup(one.view(), u, v) * lookup(seen, u, v); });
}

TEST(LevelSums, MeansHaveTheirOwnSquares) {
  const Image image = testing::random_image(4, kSize, kSize, 1);
  const Image means = testing::random_image(5, kSize, kSize, 1);
  for (const bool has_squares : {false, true}) {
    double under_tents[4][4] = {};
    const TargetSquares squares = sum_image<1>(
        half_square(), {TexelSource(image.view()), image.view(), &means}, kClamped, Reader::kLinear,
        has_squares, 2, prefilter::Run(1), [&](const MomentBlock<1>& block) {
          ASSERT_EQ(block.means != nullptr, block.level == 1);
          if (block.level > 1) return;
          for_each_dual_cell_of_means(block, [&](const auto& moments, int column, int row) {
            const auto& [all, along_x, along_y, along_both] = moments[0];
            const double corners[4] = {all - along_x - along_y + along_both, along_x - along_both,
                                       along_y - along_both, along_both};
            for (int k = 0; k < 4; ++k) {
              const int i = std::clamp(column + k % 2, 0, 3);
              const int j = std::clamp(row + k / 2, 0, 3);
              under_tents[j][i] += corners[k];
            }
          });
        });
    for (const auto& [i, j] : {std::pair(0, 0), std::pair(1, 0), std::pair(1, 2)}) {
      EXPECT_NEAR(under_tents[j][i], tent_integral(means.view(), 4, i, j), 2e-3);
    }
    if (!has_squares) continue;
    const double own =
        integral([&](double u, double v) { return std::pow(lookup(means.view(), u, v), 2); });
    const double both = integral([&](double u, double v) {
      return lookup(means.view(), u, v) * lookup(image.view(), u, v);
    });
    EXPECT_NEAR(squares.means[0], own, 2e-4 * own);
    EXPECT_NEAR(squares.image_means[0], both, 2e-4 * both);
  }
}

TEST(LevelSums, CouplingsCarryMeansToTheNextLevel) {
  const Image image = testing::random_image(4, kSize, kSize, 1);
  const Image finer = testing::random_image(6, kSize / 2, kSize / 2, 1);
  LevelCoupling coupling(kSize / 2, kSize / 2, kSize / 4, kSize / 4, kClamped);
  sum_image<1>(half_square(), {TexelSource(image.view()), image.view()}, kClamped, Reader::kLinear,
               false, 2, prefilter::Run(1), [&](const MomentBlock<1>& block) {
                 if (block.level == 1) coupling.add(block);
               });
  const NinePointSystem<float> coarse(kSize / 4, kSize / 4, kClamped);
  std::vector<LaneValues> sums(coarse.size());
  sums[0].v[0] = 10.0F;
  coupling.add_fine(finer, coarse, prefilter::Run(1), &sums);
  for (const auto& [i, j] : {std::pair(0, 0), std::pair(1, 0), std::pair(0, 1), std::pair(1, 1)}) {
    const double before = i + j == 0 ? 10.0 : 0.0;
    EXPECT_NEAR(sums[coarse.at(i, j)].v[0], before + tent_integral(finer.view(), 2, i, j), 5e-3);
  }
}

TEST(LevelSums, ThereIsOneSystemPerLevel) {
  LevelSystems<3> linear(16, 8, 4, kClamped, Reader::kLinear);
  ASSERT_EQ(linear.linear.size(), 3U);
  EXPECT_TRUE(linear.encoded.empty());
  EXPECT_TRUE(linear.couplings.empty());
  const Image means = linear.linear[1]->means();
  EXPECT_EQ(means.width, 4);
  EXPECT_EQ(means.height, 2);
  linear.expect_finer_means();
  EXPECT_EQ(linear.couplings.size(), 2U);
  EXPECT_EQ(LevelSystems<3>(16, 8, 4, kClamped, Reader::kSrgbAfter).encoded.size(), 3U);
}

}  // namespace
}  // namespace prefilter
