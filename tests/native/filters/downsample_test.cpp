#include "prefilter/filters/downsample.h"

#include <gtest/gtest.h>

#include <random>

namespace prefilter {
namespace {

// Straight from the definition: a sum over the whole plane.
float expected(const Image& source, int factor_x, int factor_y, const Kernel& kernel,
               WrapModes wrap, int tx, int ty, int channel) {
  double sum = 0.0;
  double weight_sum = 0.0;
  const int reach = 4 * std::max(factor_x, factor_y);
  for (int y = ty * factor_y - reach; y < (ty + 1) * factor_y + reach; ++y) {
    for (int x = tx * factor_x - reach; x < (tx + 1) * factor_x + reach; ++x) {
      const double along_x =
          factor_x == 1 ? (x == tx) : kernel.value((x + 0.5) / factor_x - (tx + 0.5));
      const double along_y =
          factor_y == 1 ? (y == ty) : kernel.value((y + 0.5) / factor_y - (ty + 0.5));
      const int i = wrap_index(x, source.width, wrap.u);
      const int j = wrap_index(y, source.height, wrap.v);
      weight_sum += along_x * along_y;
      if (i >= 0 && j >= 0) sum += along_x * along_y * source.texel(i, j)[channel];
    }
  }
  return static_cast<float>(sum / weight_sum);
}

TEST(Downsample, MatchesItsDefinition) {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> value(0.0F, 1.0F);
  int count = 0;
  for (const Kernel& kernel : kernels()) {
    const int channels = 1 + count++ % kMaxChannels;
    Image source(24, 16, channels);
    for (float& texel : source.data) texel = value(random);
    for (const WrapModes wrap :
         {WrapModes{Wrap::kClamp, Wrap::kRepeat}, WrapModes{Wrap::kBorder, Wrap::kClamp}}) {
      for (const auto& [fx, fy] : {std::pair{2, 2}, std::pair{3, 8}, std::pair{1, 4}}) {
        const Image target =
            downsample(source.view(), 24 / fx, 16 / fy, kernel, wrap, Progress(), 2);
        ASSERT_EQ(target.width, 24 / fx);
        ASSERT_EQ(target.height, 16 / fy);
        for (int y = 0; y < target.height; ++y) {
          for (int x = 0; x < target.width; ++x) {
            for (int c = 0; c < channels; ++c) {
              ASSERT_NEAR(target.texel(x, y)[c], expected(source, fx, fy, kernel, wrap, x, y, c),
                          2e-6);
            }
          }
        }
      }
    }
  }
}

}  // namespace
}  // namespace prefilter
