// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/images/filters/push_pull.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace prefilter {
namespace {

TEST(FillHoles, KeepsTexelsWithWeightAndFillsTheRest) {
  for (const int width : {1, 2, 7, 32}) {
    for (const int height : {1, 5, 16}) {
      Image image(width, height, 2, std::numeric_limits<float>::quiet_NaN());
      std::vector<float> weights(image.view().texel_count(), 0.0F);
      image.texel(0, height / 2)[0] = 0.25F;
      image.texel(0, height / 2)[1] = -4.0F;
      weights[static_cast<std::size_t>(height / 2) * width] = 0.001F;
      fill_holes(weights, {}, 2, prefilter::Run(2), &image);
      for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
          EXPECT_NEAR(image.texel(x, y)[0], 0.25F, 1e-6);
          EXPECT_NEAR(image.texel(x, y)[1], -4.0F, 1e-5);
        }
      }
    }
  }
}

// One texel of every 2 x 2 is known, and defines the next coarser layer. The center of a hole is a
// quarter of a coarse texel away from its parent's center, along both axes.
TEST(FillHoles, InterpolatesTheCoarserLayer) {
  Image image(4, 4, 1);
  std::vector<float> weights(16, 0.0F);
  const float known[2][2] = {{1.0F, 3.0F}, {-2.0F, 10.0F}};
  for (int j = 0; j < 2; ++j) {
    for (int i = 0; i < 2; ++i) {
      image.texel(2 * i, 2 * j)[0] = known[j][i];
      weights[static_cast<std::size_t>(8 * j + 2 * i)] = 1.0F;
    }
  }
  fill_holes(weights, {}, 1, prefilter::Run(1), &image);
  const auto between = [&](int x, int y) {
    const double u = std::min(std::max(0.5 * (x + 0.5) - 0.5, 0.0), 1.0);
    const double v = std::min(std::max(0.5 * (y + 0.5) - 0.5, 0.0), 1.0);
    return (1.0 - v) * ((1.0 - u) * known[0][0] + u * known[0][1]) +
           v * ((1.0 - u) * known[1][0] + u * known[1][1]);
  };
  for (int y = 0; y < 4; ++y) {
    for (int x = 0; x < 4; ++x) {
      const bool is_known = x % 2 == 0 && y % 2 == 0;
      EXPECT_NEAR(image.texel(x, y)[0], is_known ? known[y / 2][x / 2] : between(x, y), 1e-6);
    }
  }
}

TEST(FillHoles, StaysBetweenTheValuesAround) {
  Image image(16, 16, 1);
  std::vector<float> weights(256, 0.0F);
  for (int y = 0; y < 16; ++y) {
    image.texel(0, y)[0] = 1.0F;
    image.texel(15, y)[0] = 3.0F;
    weights[16 * y] = weights[16 * y + 15] = 1.0F;
  }
  fill_holes(weights, {}, 1, prefilter::Run(2), &image);
  for (int x = 1; x < 16; ++x) {
    EXPECT_GE(image.texel(x, 8)[0], image.texel(x - 1, 8)[0]);
    EXPECT_LE(image.texel(x, 8)[0], 3.0F);
  }
}

TEST(FillHoles, FullQuartersCountLikeSingleTexels) {
  Image image(4, 4, 1);
  std::vector<float> weights(16, 0.0F);
  weights[0] = 1.0F;  // its value is 0
  for (const int at : {2, 3, 6, 7}) {
    image.data[static_cast<std::size_t>(at)] = 1.0F;
    weights[static_cast<std::size_t>(at)] = 1.0F;
  }
  fill_holes(weights, {}, 1, prefilter::Run(1), &image);
  // The last quarter has no texel: it gets the mean of the other quarters.
  EXPECT_NEAR(image.texel(3, 3)[0], 0.5F, 1e-6);
}

TEST(FillHoles, ReadsAcrossTheEdgesOfARepeatedImage) {
  for (const Wrap mode : {Wrap::kRepeat, Wrap::kClamp}) {
    Image image(4, 1, 1);
    image.texel(3, 0)[0] = 1.0F;
    fill_holes({0.0F, 1.0F, 0.0F, 1.0F}, {mode, mode}, 1, prefilter::Run(1), &image);
    // The first texel is a quarter of a coarse one from the edge, beyond which is the last one.
    EXPECT_EQ(image.texel(0, 0)[0], mode == Wrap::kRepeat ? 0.25F : 0.0F);
  }
}

TEST(FillHoles, LeavesAnImageWithoutAnyWeight) {
  Image image(4, 4, 1, 7.0F);
  fill_holes(std::vector<float>(16, 0.0F), {}, 1, prefilter::Run(1), &image);
  for (const float value : image.data) EXPECT_EQ(value, 7.0F);
}

TEST(FillHoles, LeavesFurtherChannels) {
  Image image(4, 4, 2, 5.0F);
  std::vector<float> weights(16, 0.0F);
  weights[0] = 1.0F;
  image.texel(0, 0)[0] = 1.0F;
  fill_holes(weights, {}, 1, prefilter::Run(2), &image);
  EXPECT_EQ(image.texel(3, 3)[0], 1.0F);
  EXPECT_EQ(image.texel(3, 3)[1], 5.0F);
}

}  // namespace
}  // namespace prefilter
