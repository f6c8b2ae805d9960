// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/images/resize.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <utility>

#include "prefilter/base/error.h"
#include "prefilter/images/filters/windowed_jinc.h"

namespace prefilter {
namespace {

Image random_image(int width, int height, int channels) {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> value(0.0F, 1.0F);
  Image image(width, height, channels);
  for (float& texel : image.data) texel = value(random);
  return image;
}

Image resized(const Image& image, int width, int height, const std::string& filter, int threads) {
  ResizeOptions options;
  options.filter = resize_filter(filter);
  options.wrap = {Wrap::kRepeat, Wrap::kClamp};
  options.run = prefilter::Run(threads);
  return resize(image.view(), width, height, options);
}

TEST(ResizeFilter, IsFoundByItsName) {
  for (const ResizeFilter& filter : resize_filters()) {
    EXPECT_EQ(resize_filter(name_of(filter)), filter);
  }
  EXPECT_THROW(resize_filter("radial4"), Error);
}

TEST(Resize, IsTheSameForAnyNumberOfThreads) {
  for (const ResizeFilter& filter : resize_filters()) {
    for (int channels = 1; channels <= kMaxChannels; ++channels) {
      const Image image = random_image(97, 71, channels);
      for (const auto& [width, height] : {std::pair{66, 65}, std::pair{1, 130}, std::pair{7, 1}}) {
        const std::vector<float> one = resized(image, width, height, name_of(filter), 1).data;
        EXPECT_EQ(one, resized(image, width, height, name_of(filter), 3).data) << name_of(filter);
        EXPECT_TRUE(std::all_of(one.begin(), one.end(), [](float v) { return std::isfinite(v); }));
      }
    }
  }
}

// So many taps that they are summed in parts, and so dense that their sum is the filter's integral,
// 1.
TEST(Resize, OneTexelSpreadsLikeTheFilter) {
  constexpr int kSize = 400;
  ResizeOptions options;
  options.filter = RadialFilter{3};
  options.wrap = {Wrap::kBorder, Wrap::kBorder};
  for (const auto& [x, y] : {std::pair{200, 199}, std::pair{3, 250}, std::pair{399, 0}}) {
    Image image(kSize, kSize, 1);
    *image.texel(x, y) = 1.0F;
    const Image one = resize(image.view(), 1, 1, options);
    const double distance = std::hypot((x + 0.5) / kSize - 0.5, (y + 0.5) / kSize - 0.5);
    EXPECT_NEAR(one.data[0] * kSize * kSize, windowed_jinc(distance, 3.0), 1e-6);
  }
}

}  // namespace
}  // namespace prefilter
