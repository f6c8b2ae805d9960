// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/textures/keep_coverage.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <utility>

#include "prefilter/base/error.h"

namespace prefilter {
namespace {

// An alpha ramp along u, raised to a power.
Image ramp(int side, double power) {
  Image image(side, side, 1);
  for (int y = 0; y < side; ++y) {
    for (int x = 0; x < side; ++x) {
      *image.texel(x, y) = static_cast<float>(std::pow((x + 0.5) / side, power));
    }
  }
  return image;
}

// The position in [0, 1] at which a lookup along the middle row first reaches the threshold.
double edge(const Image& level, double threshold) {
  const float* row = level.texel(0, level.height / 2);
  int x = 0;
  while (x < level.width && row[x] < threshold) ++x;
  return (x - 0.5 + (threshold - row[x - 1]) / (row[x] - row[x - 1])) / level.width;
}

TEST(KeepCoverage, MovesTheEdgeOfARampBack) {
  for (const auto& [power, threshold] : {std::pair{0.3, 0.8}, std::pair{3.0, 0.25}}) {
    const Image image = ramp(64, 1.0);
    const Image level = ramp(32, power);
    CoverageOptions options;
    options.threshold = threshold;
    const std::vector<Image> kept = keep_coverage({image.view(), level.view()}, {}, options);
    ASSERT_EQ(kept.size(), 1U);
    EXPECT_GT(std::abs(edge(level, threshold) - threshold), 0.03);
    EXPECT_NEAR(edge(kept[0], threshold), threshold, 3e-3) << power;
  }
}

TEST(KeepCoverage, KeepsLevelsWithinTheTolerance) {
  const Image image = ramp(64, 1.0);
  const Image level = ramp(32, 1.0);
  const std::vector<Image> kept = keep_coverage({image.view(), level.view()}, {}, {});
  EXPECT_EQ(kept[0].data, level.data);
}

TEST(KeepCoverage, ChangesColorsThatAreMultiplied) {
  const Image image = ramp(64, 1.0);
  const auto with_colors = [](const Image& alpha) {
    Image result(alpha.width, alpha.height, 4);
    for (std::size_t i = 0; i < alpha.data.size(); ++i) {
      for (int c = 0; c < 4; ++c) {
        result.data[4 * i + c] = alpha.data[i] * (c < 3 ? 0.25F * static_cast<float>(c + 1) : 1.0F);
      }
    }
    return result;
  };
  const Image fine = with_colors(image);
  const Image coarse = with_colors(ramp(32, 3.0));
  for (const bool premultiplied : {false, true}) {
    CoverageOptions options;
    options.premultiplied = premultiplied;
    const Image kept = keep_coverage({fine.view(), coarse.view()}, {}, options)[0];
    for (std::size_t i = 0; i < kept.data.size(); i += 4) {
      EXPECT_GT(kept.data[i + 3], coarse.data[i + 3]);
      for (int c = 0; c < 3; ++c) {
        const float expected = premultiplied ? 0.25F * static_cast<float>(c + 1) * kept.data[i + 3]
                                             : coarse.data[i + c];
        EXPECT_NEAR(kept.data[i + c], expected, 1e-6);
      }
    }
  }
}

TEST(KeepCoverage, TakesAnythingAsLevelZero) {
  const Image image(4, 4, 1, 0.5F);
  const Image bad(2, 2, 1, std::numeric_limits<float>::quiet_NaN());
  EXPECT_NO_THROW(keep_coverage({bad.view(), image.view()}, {}, {}));
}

TEST(KeepCoverage, StopsWhenCancelled) {
  const Image image = ramp(64, 1.0);
  const Image level = ramp(32, 3.0);
  for (const double until : {0.0, 0.35, 0.5}) {
    CoverageOptions options;
    options.run = prefilter::Run([until](double fraction) { return fraction <= until; });
    EXPECT_THROW(keep_coverage({image.view(), level.view(), level.view()}, {}, options), Error);
  }
}

}  // namespace
}  // namespace prefilter
