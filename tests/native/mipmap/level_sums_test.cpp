// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/mipmap/level_sums.h"

#include <gtest/gtest.h>

#include <cmath>

#include "prefilter/color/transfer.h"
#include "texels/scenes.h"

namespace prefilter {
namespace {

constexpr WrapModes kClamped{Wrap::kClamp, Wrap::kClamp};
constexpr int kSize = 8;

// The lower left half of the unit square, of area 1/2 in space.
TexelTriangles half_square() {
  static const Surface surface = testing::one_triangle({{{0.0, 0.0}, {1.0, 0.0}, {0.0, 1.0}}}, 0.5);
  return map_to_texels({&surface}, kSize, kSize, kClamped, MassOf::kArea, Progress(), 1);
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

// The integral over the triangle of what `value` says, by a fine grid. Sweeps count all of the
// surface as so many texels as the image has.
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

TEST(LevelSums, SquaresAreThoseOfWhatTheReaderShows) {
  const Image image = testing::random_image(3, kSize, kSize, 1);
  const auto sum = [&](const Image& swept, Reader reader, bool has_squares) {
    int blocks = 0;
    const ChannelSums sums =
        sum_image<1>(half_square(), TexelSource(swept.view()), image.view(), kClamped, reader,
                     has_squares, 2, Progress(), 1, [&](const MomentBlock<1>& block) {
                       EXPECT_GT(block.level, 0);
                       EXPECT_LE(block.level, 2);
                       ++blocks;
                     });
    EXPECT_GT(blocks, 1);
    return sums[0];
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

TEST(LevelSums, MeansHaveTheirOwnSquares) {
  const Image image = testing::random_image(4, kSize, kSize, 1);
  const Image means = testing::random_image(5, kSize, kSize, 1);
  const std::vector<Image> level_means = {Image(),
                                          testing::random_image(6, kSize / 2, kSize / 2, 1)};
  // What level 2 sees are the means of level 1, and level 1 those of the image.
  BilinearSystem<1> first(kSize / 2, kSize / 2, kClamped);
  BilinearSystem<1> second(kSize / 4, kSize / 4, kClamped);
  TargetSquares squares;
  sum_means<1>(
      half_square(), means.view(), level_means, image.view(), kClamped, true, Progress(), 1,
      [&](const MomentBlock<1>& block) { (block.level == 1 ? first : second).add(block); },
      &squares);
  const double own =
      integral([&](double u, double v) { return std::pow(lookup(means.view(), u, v), 2); });
  const double both = integral(
      [&](double u, double v) { return lookup(means.view(), u, v) * lookup(image.view(), u, v); });
  EXPECT_NEAR(squares.means[0], own, 2e-4 * own);
  EXPECT_NEAR(squares.image_means[0], both, 2e-4 * both);
  // A level's mean at a texel is that of what it sees under the texel's tent.
  const auto mean_at = [&](const ImageView& seen, int size, int i, int j) {
    Image one(size, size, 1);
    *one.texel(i, j) = 1.0F;
    const auto tent = [&](double u, double v) { return lookup(one.view(), u, v); };
    return integral([&](double u, double v) { return tent(u, v) * lookup(seen, u, v); }) /
           integral(tent);
  };
  EXPECT_NEAR(*first.means().texel(1, 0), mean_at(means.view(), 4, 1, 0), 1e-3);
  EXPECT_NEAR(*second.means().texel(0, 0), mean_at(level_means[1].view(), 2, 0, 0), 1e-3);
}

TEST(LevelSums, SystemsAreOneALevel) {
  const LevelSystems<3> linear(16, 8, 4, kClamped, Reader::kLinear);
  ASSERT_EQ(linear.linear.size(), 3U);
  EXPECT_TRUE(linear.encoded.empty());
  const std::vector<Image> means = linear.means();
  ASSERT_EQ(means.size(), 3U);
  EXPECT_EQ(means[1].width, 8);
  EXPECT_EQ(means[2].width, 4);
  EXPECT_EQ(means[2].height, 2);
  EXPECT_EQ(LevelSystems<3>(16, 8, 4, kClamped, Reader::kSrgbAfter).encoded.size(), 3U);
}

}  // namespace
}  // namespace prefilter
