// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/voxels/outlines.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "prefilter/base/error.h"
#include "voxels/contour/half_planes.h"

namespace prefilter {
namespace {

TEST(ContourOutlines, OutlinesAreClosedAndExactForHalfPlanes) {
  constexpr int kSize = 20;
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform(0.0, 6.28);
  for (int trial = 0; trial < 50; ++trial) {
    const double angle = uniform(random);
    const double a = std::cos(angle);
    const double b = std::sin(angle);
    const double c = a * 10.2 + b * 9.7;
    std::vector<float> values;
    for (int x = 0; x < kSize; ++x) {
      for (int y = 0; y < kSize; ++y) {
        values.push_back(static_cast<float>(testing::share_below(x, y, a, b, c)));
      }
    }
    const std::vector<OutlinePoints> lines =
        contour_outlines({values.data(), {kSize, kSize}}, {}, {});
    ASSERT_EQ(lines.size(), 1U);
    double area = 0.0;
    for (std::size_t i = 0; i < lines[0].size(); ++i) {
      const auto& p = lines[0][i];
      const auto& q = lines[0][(i + 1) % lines[0].size()];
      area += p[0] * q[1] - p[1] * q[0];
      const bool is_inner = p[0] > 2 && p[0] < kSize - 2 && p[1] > 2 && p[1] < kSize - 2;
      if (is_inner) {
        EXPECT_NEAR(a * p[0] + b * p[1], c, 2e-5);
      }
    }
    EXPECT_GT(area, 0.0);  // the inside is on the left
  }
}

TEST(ContourOutlines, DiagonalCellsAreSeparate) {
  const std::vector<float> values = {1.0F, 0.0F, 0.0F, 1.0F};
  EXPECT_EQ(contour_outlines({values.data(), {2, 2}}, {}, {}).size(), 2U);
  const std::vector<float> none(4, 0.0F);
  EXPECT_TRUE(contour_outlines({none.data(), {2, 2}}, {}, {}).empty());
}

TEST(ContourOutlines, FollowTheBounds) {
  const std::vector<float> one = {1.0F};
  const double far = 1e7;
  const double tiny = 1e-3;
  const std::vector<OutlinePoints> lines =
      contour_outlines({one.data(), {1, 1}}, {{far, -far}, {tiny, 2.0 * tiny}}, ContourOptions());
  ASSERT_EQ(lines.size(), 1U);
  double area = 0.0;
  for (std::size_t i = 0; i < 4; ++i) {
    const auto& p = lines[0][i];
    const auto& q = lines[0][(i + 1) % 4];
    area += ((p[0] - far) * (q[1] + far) - (p[1] + far) * (q[0] - far)) / 2.0;
    EXPECT_NEAR(
        std::abs(p[0] - far - 0.5 * tiny) / tiny + std::abs(p[1] + far - tiny) / (2.0 * tiny), 0.5,
        1e-5);
  }
  EXPECT_NEAR(area, tiny * tiny, 1e-4 * tiny * tiny);  // half of a cell
}

TEST(ContourOutlines, ReportInvalidArguments) {
  const std::vector<float> nan = {std::numeric_limits<float>::quiet_NaN()};
  const std::vector<float> one = {1.0F};
  EXPECT_THROW(contour_outlines({nan.data(), {1, 1}}, {}, {}), Error);
  EXPECT_THROW(contour_outlines({one.data(), {1, 0}}, {}, {}), Error);
  EXPECT_THROW(contour_outlines({one.data(), {1, 1}}, {{1e20, 0.0}, {1.0, 1.0}}, {}), Error);
  EXPECT_THROW(contour_outlines({one.data(), {1, 1}}, {{}, {1e308, 1.0}}, {}), Error);
}

}  // namespace
}  // namespace prefilter
