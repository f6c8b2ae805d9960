// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/textures/mipmap/covered_share.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "prefilter/base/error.h"

namespace prefilter {
namespace {

constexpr WrapModes kClamp = {Wrap::kClamp, Wrap::kClamp};

double share(const Image& alpha, const Image& weights, float threshold, int samples = 16,
             WrapModes wrap = kClamp, int threads = 1) {
  return covered_share(alpha.view(), weights.view(), samples, threshold, wrap,
                       prefilter::Run(threads));
}

TEST(CoveredShare, OneTexelCoversItsHyperbolas) {
  Image alpha(5, 5, 1);
  *alpha.texel(2, 2) = 1.0F;
  // In each quadrant, (1 - x) (1 - y) >= t: the integral of 1 - t / (1 - x) up to x = 1 - t.
  for (const double t : {0.2, 0.5, 0.8}) {
    const double texels = 4.0 * (1.0 - t + t * std::log(t));
    EXPECT_NEAR(share(alpha, Image(5, 5, 1, 1.0F), static_cast<float>(t), 128), texels / 25.0, 2e-4)
        << t;
  }
}

TEST(CoveredShare, CellsCountByTheirWeight) {
  Image alpha(8, 8, 1);
  for (int y = 0; y < 8; ++y) {
    for (int x = 4; x < 8; ++x) *alpha.texel(x, y) = 1.0F;
  }
  Image weights(2, 1, 1);
  *weights.texel(0, 0) = 3.0F;
  *weights.texel(1, 0) = 1.0F;
  EXPECT_NEAR(share(alpha, weights, 0.5F), 0.25, 1e-12);
  *weights.texel(1, 0) = 0.0F;
  EXPECT_EQ(share(alpha, weights, 0.5F), 0.0);
}

TEST(CoveredShare, WrapModesReachOverTheEdges) {
  Image alpha(4, 1, 1);
  *alpha.texel(0, 0) = 1.0F;
  const Image weights(4, 1, 1, 1.0F);
  // To the right, half of the gap between centers; to the left, the rest of the texel, or half of
  // the gap to the wrapped texel.
  EXPECT_NEAR(share(alpha, weights, 0.5F, 16), 1.0 / 4.0, 1e-12);
  EXPECT_NEAR(share(alpha, weights, 0.75F, 16), 0.75 / 4.0, 1e-12);
  EXPECT_NEAR(share(alpha, weights, 0.75F, 16, {Wrap::kRepeat, Wrap::kClamp}), 0.5 / 4.0, 1e-12);
  EXPECT_NEAR(share(alpha, weights, 0.75F, 16, {Wrap::kBorder, Wrap::kClamp}), 0.5 / 4.0, 1e-12);
}

TEST(CoveredShare, NonfiniteValuesDoNotCount) {
  Image alpha(4, 4, 1, 1.0F);
  *alpha.texel(1, 1) = std::numeric_limits<float>::quiet_NaN();
  Image zero = alpha;
  *zero.texel(1, 1) = 0.0F;
  const Image weights(4, 4, 1, 1.0F);
  EXPECT_EQ(share(alpha, weights, 0.5F), share(zero, weights, 0.5F));
}

TEST(CoveredShare, ThreadsDoNotMatter) {
  Image alpha(37, 53, 1);
  Image weights(64, 32, 1);
  unsigned state = 1;
  const auto next = [&state] {
    state = state * 1664525U + 1013904223U;
    return static_cast<float>(state >> 8) / 16777216.0F;
  };
  for (float& value : alpha.data) value = next();
  for (float& value : weights.data) value = next();
  EXPECT_EQ(share(alpha, weights, 0.4F, 3, kClamp, 1), share(alpha, weights, 0.4F, 3, kClamp, 5));
}

TEST(CoveredShare, RefusesInvalidValues) {
  const Image one(2, 2, 1, 1.0F);
  EXPECT_THROW(share(Image(2, 2, 3), one, 0.5F), Error);
  EXPECT_THROW(share(one, Image(2, 2, 2), 0.5F), Error);
  EXPECT_THROW(share(one, one, 0.5F, 0), Error);
  EXPECT_THROW(share(one, Image(2, 2, 1), 0.5F), Error);
}

}  // namespace
}  // namespace prefilter
