// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/sampling/resample.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace prefilter {
namespace {

Image pattern(int width, int height, int channels) {
  Image image(width, height, channels);
  for (std::size_t i = 0; i < image.data.size(); ++i) {
    image.data[i] = 0.25F + 0.5F * static_cast<float>(i * 7 % 11) / 11.0F;
  }
  return image;
}

TEST(PixelPlace, FollowsTheTransform) {
  const Homography transform = {2.0, 0.3, -5.0, 0.1, 1.5, -8.0, 0.002, 0.05, -0.2};
  constexpr double kStep = 1e-6;
  for (int row = 0; row < 12; ++row) {
    const PixelPlace place = pixel_place(transform, 3, row, 32, 24);
    const auto carried = [&](double x, double y) {
      const double w = 0.002 * x + 0.05 * y - 0.2;
      return std::array<double, 3>{(2.0 * x + 0.3 * y - 5.0) / w, (0.1 * x + 1.5 * y - 8.0) / w, w};
    };
    const double x = 3.5;
    const double y = row + 0.5;
    ASSERT_EQ(place.is_visible, carried(x, y)[2] > 0.0) << row;
    if (!place.is_visible) continue;
    EXPECT_NEAR(place.coordinates[0], carried(x, y)[0] / 32.0, 1e-9);
    EXPECT_NEAR(place.coordinates[1], carried(x, y)[1] / 24.0, 1e-9);
    for (int axis = 0; axis < 2; ++axis) {
      const double along_i = carried(x + kStep, y)[axis] - carried(x - kStep, y)[axis];
      const double along_j = carried(x, y + kStep)[axis] - carried(x, y - kStep)[axis];
      const double tolerance = 1e-6 * (1.0 + std::abs(along_j) / kStep);
      EXPECT_NEAR(place.jacobian[2 * axis], along_i / (2.0 * kStep), tolerance);
      EXPECT_NEAR(place.jacobian[2 * axis + 1], along_j / (2.0 * kStep), tolerance);
    }
  }
}

// Also for the sanitizers: no index or conversion is out of range.
TEST(Resample, IsFiniteForAnyTransform) {
  const std::vector<Homography> transforms = {
      {1e300, 1e300, 1e300, 1e300, 1e300, 1e300, 1e300, 1e300, 1e300},
      {1e-300, 1e-300, 1e-300, 1e-300, 1e-300, 1e-300, 1e-300, 1e-300, 1e-300},
      {1e308, 0, 0, 0, 1e308, 0, 0, 0, 1e-308},
      {1e200, 0, 0, 0, 1e-200, 0, 0, 0, 1},
      {1e15, 1, 0, 1, 1e-3, 0, 0, 0, 1},
      {0, 0, 1e-300, 0, 0, 1, 0, 0, 1},
      {1, 1, 0, 1, 1, 0, 1e-9, 1e-9, -1e-8},
      {0, 0, 0, 0, 0, 0, 0, 0, 0},
      {-3e9, 0, 7, 0, 2e9, 5, 0, 0, 1},
      {3, 0, -1e12, 0, 3, 1e12, 0, 0, 1},
  };
  for (const auto& [width, height] : {std::pair{5, 3}, std::pair{1, 1}, std::pair{64, 1}}) {
    const Image image = pattern(width, height, 4);
    for (const Homography& transform : transforms) {
      for (const Wrap mode : {Wrap::kClamp, Wrap::kRepeat, Wrap::kBorder}) {
        for (const auto method :
             {ResampleOptions::Method::kTrilinear, ResampleOptions::Method::kExact}) {
          for (const int probes : {1, 5}) {
            ResampleOptions options;
            options.method = method;
            options.kernel = find_kernel("gaussian");
            options.max_probes = probes;
            options.wrap = {mode, mode};
            const Image found = resample(image.view(), transform, 4, 4, options);
            EXPECT_TRUE(std::all_of(found.data.begin(), found.data.end(),
                                    [](float value) { return std::isfinite(value); }));
          }
        }
      }
    }
  }
}

}  // namespace
}  // namespace prefilter
