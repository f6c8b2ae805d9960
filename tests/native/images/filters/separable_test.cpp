// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/images/filters/separable.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <utility>

namespace prefilter {
namespace {

Image random_image(int width, int height, int channels) {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> value(0.0F, 1.0F);
  Image image(width, height, channels);
  for (float& texel : image.data) texel = value(random);
  return image;
}

// The weight of texel x for target texel t, by the definition.
double weight(const Kernel& kernel, double ratio, int t, int x) {
  if (ratio == 1.0) return x == t ? 1.0 : 0.0;
  const double center = (t + 0.5) * ratio;
  if (kernel.name() == "box") {
    return std::max(
        0.0, std::min(x + 1.0, center + 0.5 * ratio) - std::max<double>(x, center - 0.5 * ratio));
  }
  return kernel.value((x + 0.5 - center) / std::max(1.0, ratio));
}

// Directly from the definition: a sum over the whole plane.
float expected(const Image& source, int width, int height, const Kernel& kernel, WrapModes wrap,
               int tx, int ty, int channel) {
  const double ratio_x = static_cast<double>(source.width) / width;
  const double ratio_y = static_cast<double>(source.height) / height;
  double sum = 0.0;
  double weight_sum = 0.0;
  const int reach = 4 * std::max(source.width, source.height);
  for (int y = -reach; y < source.height + reach; ++y) {
    const double along_y = weight(kernel, ratio_y, ty, y);
    if (along_y == 0.0) continue;
    for (int x = -reach; x < source.width + reach; ++x) {
      const double along_x = weight(kernel, ratio_x, tx, x);
      const int i = wrap_index(x, source.width, wrap.u);
      const int j = wrap_index(y, source.height, wrap.v);
      weight_sum += along_x * along_y;
      if (i >= 0 && j >= 0) sum += along_x * along_y * source.texel(i, j)[channel];
    }
  }
  return static_cast<float>(sum / weight_sum);
}

TEST(FilterSeparably, MatchesItsDefinition) {
  int count = 0;
  for (const Kernel& kernel : kernels()) {
    const int channels = 1 + count++ % kMaxChannels;
    const Image source = random_image(12, 8, channels);
    for (const WrapModes wrap :
         {WrapModes{Wrap::kClamp, Wrap::kRepeat}, WrapModes{Wrap::kBorder, Wrap::kClamp}}) {
      for (const auto& [width, height] : {std::pair{6, 4}, std::pair{4, 1}, std::pair{12, 2},
                                          std::pair{7, 5}, std::pair{31, 16}, std::pair{24, 3}}) {
        const Image target =
            filter_separably(source.view(), width, height, kernel, wrap, prefilter::Run(2));
        ASSERT_EQ(target.width, width);
        ASSERT_EQ(target.height, height);
        for (int y = 0; y < height; ++y) {
          for (int x = 0; x < width; ++x) {
            for (int c = 0; c < channels; ++c) {
              ASSERT_NEAR(target.texel(x, y)[c],
                          expected(source, width, height, kernel, wrap, x, y, c), 2e-6)
                  << kernel.name() << " to " << width << " x " << height;
            }
          }
        }
      }
    }
  }
}

// Incomplete blocks of columns and groups of rows, and more taps than a block has terms.
TEST(FilterSeparably, IsTheSameForAnyNumberOfThreads) {
  const Kernel& kernel = *find_kernel("lanczos3");
  for (int channels = 1; channels <= kMaxChannels; ++channels) {
    const Image source = random_image(1100, 37, channels);
    const auto filter = [&](int threads) {
      return filter_separably(source.view(), 733, 51, kernel, {}, prefilter::Run(threads)).data;
    };
    const std::vector<float> one = filter(1);
    EXPECT_EQ(one, filter(2));
    EXPECT_EQ(one, filter(7));
  }
}

TEST(FilterSeparably, KeepsConstantsToTheLastBit) {
  constexpr float kValue = 0.1F;
  const Image source(13, 9, 3, kValue);
  for (const Kernel& kernel : kernels()) {
    for (const auto& [width, height] : {std::pair{5, 3}, std::pair{40, 1}, std::pair{29, 31}}) {
      const Image target = filter_separably(source.view(), width, height, kernel,
                                            {Wrap::kClamp, Wrap::kRepeat}, prefilter::Run(1));
      EXPECT_TRUE(std::all_of(target.data.begin(), target.data.end(), [](float value) {
        return value == kValue;
      })) << kernel.name();
    }
  }
}

}  // namespace
}  // namespace prefilter
