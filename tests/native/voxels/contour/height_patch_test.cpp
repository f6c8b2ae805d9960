// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/voxels/contour/height_patch.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <utility>

namespace prefilter {
namespace {

// Coefficients of a + b s + c t + d s s + e t t + f s t.
using Quadratic = std::array<double, 6>;

double value_of(const Quadratic& q, double s, double t) {
  return q[0] + q[1] * s + q[2] * t + q[3] * s * s + q[4] * t * t + q[5] * s * t;
}

// Mean over the unit square around (s, t) by Simpson's rule, which is exact here.
double mean_of(const Quadratic& q, double s, double t) {
  double sum = 0.0;
  for (int i = -1; i <= 1; ++i) {
    for (int j = -1; j <= 1; ++j) {
      const double weight = (i == 0 ? 4.0 : 1.0) * (j == 0 ? 4.0 : 1.0) / 36.0;
      sum += weight * value_of(q, s + 0.5 * i, t + 0.5 * j);
    }
  }
  return sum;
}

std::array<std::array<double, 3>, 3> heights_of(const Quadratic& q) {
  std::array<std::array<double, 3>, 3> heights;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      heights[i][j] = mean_of(q, static_cast<double>(i) - 1.0, static_cast<double>(j) - 1.0);
    }
  }
  return heights;
}

HeightPatch patch_along(int axis, bool is_up) {
  HeightPatch patch;
  patch.center = {3.5, 4.5, 5.5};
  patch.axis = axis;
  patch.is_up = is_up;
  return patch;
}

TEST(HeightPatch, FitsQuadraticsExactly) {
  std::mt19937 random(8);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  for (int round = 0; round < 100; ++round) {
    Quadratic q;
    for (std::size_t i = 0; i < 6; ++i) q[i] = (i < 3 ? 0.4 : 0.05) * uniform(random);
    HeightPatch patch = patch_along(round % 3, round % 2 == 0);
    ASSERT_TRUE(fit_heights(heights_of(q), &patch));
    const double up = patch.is_up ? 1.0 : -1.0;
    for (int k = 0; k < 10; ++k) {
      const std::array<double, 3> offset = {uniform(random), uniform(random), uniform(random)};
      Vector3 point = patch.center;
      for (int a = 0; a < 3; ++a)
        point[(patch.axis + a) % 3] += offset[static_cast<std::size_t>(a)];
      Vector3 gradient;
      const double above = patch.above(point, &gradient);
      EXPECT_NEAR(above, up * offset[0] - value_of(q, offset[1], offset[2]), 1e-12);
      for (int a = 0; a < 3; ++a) {  // by central differences, which are exact here
        Vector3 step{};
        step[a] = 0.5;
        EXPECT_NEAR(gradient[a],
                    patch.above(point + step, nullptr) - patch.above(point - step, nullptr), 1e-12);
      }
      Vector3 there;
      const Vector3 foot = patch.projected(point, &there);
      EXPECT_NEAR(patch.above(foot, nullptr), 0.0, 1e-3);
    }
    EXPECT_NEAR(length(patch.normal()), 1.0, 1e-12);
    EXPECT_GT(up * patch.normal()[patch.axis], 0.0);
    // The foot has the mean height of the middle column.
    EXPECT_NEAR(up * (patch.foot()[patch.axis] - patch.center[patch.axis]), mean_of(q, 0.0, 0.0),
                1e-12);
  }
}

TEST(HeightPatch, IsNoneForCurvedOrRoughSurfaces) {
  HeightPatch patch = patch_along(2, true);
  EXPECT_TRUE(fit_heights(heights_of({0.0, 0.0, 0.0, 0.059, 0.0, 0.0}), &patch));
  EXPECT_FALSE(fit_heights(heights_of({0.0, 0.0, 0.0, 0.061, 0.0, 0.0}), &patch));
  EXPECT_FALSE(fit_heights(heights_of({0.0, 0.0, 0.0, 0.0, -0.061, 0.0}), &patch));
  EXPECT_FALSE(fit_heights(heights_of({0.0, 0.0, 0.0, 0.0, 0.0, 0.121}), &patch));
  // Across a slope of 45 degrees, the same second derivative is a curvature smaller by sqrt(8).
  EXPECT_TRUE(fit_heights(heights_of({0.0, 1.0, 0.0, 0.169, 0.0, 0.0}), &patch));
  EXPECT_FALSE(fit_heights(heights_of({0.0, 1.0, 0.0, 0.171, 0.0, 0.0}), &patch));
  // The middle height is off by h: its weight in the fit is 5/9, so that the residual is 4 h / 9.
  for (const auto& [off, is_fitted] : {std::pair{0.0089, true}, {0.0091, false}}) {
    auto heights = heights_of({0.2, 0.1, -0.1, 0.01, 0.02, 0.0});
    heights[1][1] += off;
    EXPECT_EQ(fit_heights(heights, &patch), is_fitted);
  }
}

}  // namespace
}  // namespace prefilter
