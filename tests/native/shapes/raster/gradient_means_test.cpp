// SPDX-License-Identifier: GPL-3.0-or-later

// Means of fine gradients against brute-force sampling, and against known means.
#include "prefilter/shapes/raster/gradient_means.h"

#include <gtest/gtest.h>

#include <cmath>

#include "prefilter/shapes/raster/gradient_cutter.h"
#include "prefilter/shapes/raster/paint_bounds.h"

namespace prefilter {
namespace {

Paint rings(double period, Spread spread) {
  Paint paint;
  paint.kind = Paint::Kind::kRadialStops;
  paint.channels = 2;
  paint.spread = spread;
  paint.end_radius = period;
  paint.stops = {{0.0, {0.0, 0.25, 0.0, 0.0}},
                 {0.25, {1.0, 0.5, 0.0, 0.0}},
                 {0.25, {0.5, 1.0, 0.0, 0.0}},
                 {1.0, {0.0, 0.75, 0.0, 0.0}}};
  return paint;
}

ChannelValues mean_of_points(const Paint& paint, const Point2& center) {
  constexpr int kSide = 400;
  ChannelValues mean{};
  for (int j = 0; j < kSide; ++j) {
    for (int i = 0; i < kSide; ++i) {
      const Point2 off{(i + 0.5) / kSide - 0.5, (j + 0.5) / kSide - 0.5};
      const ChannelValues value = paint.at(center + off);
      for (std::size_t c = 0; c < mean.size(); ++c) mean[c] += value[c] / (kSide * kSide);
    }
  }
  return mean;
}

TEST(GradientMeans, MatchSampledMeans) {
  for (const Spread spread : {Spread::kRepeat, Spread::kReflect}) {
    for (const double period : {0.3, 0.9, 2.5}) {
      const Paint paint = rings(period, spread);
      ASSERT_TRUE(has_fine_stops(paint));
      const GradientMeans means(paint);
      for (const Point2& center : {Point2{0.0, 0.0}, Point2{0.75, 0.25}, Point2{5.5, -2.25},
                                   Point2{40.5, 0.5}, Point2{-30.0, 30.0}}) {
        const ChannelValues expected = mean_of_points(paint, center);
        const ChannelValues found = means.mean_over_pixel(center);
        for (std::size_t c = 0; c < 2; ++c) {
          EXPECT_NEAR(found[c], expected[c], 1.5 / 255.0)
              << period << " at " << center.x << ", " << center.y;
        }
      }
    }
  }
}

// 1/8 + 3/16 and 3/32 + 21/32 of a period.
TEST(GradientMeans, TinyPeriodsHaveTheirMean) {
  for (const double period : {1e-3, 1e-7, 1e-14, 1e-100}) {
    const Paint paint = rings(period, Spread::kRepeat);
    const GradientMeans means(paint);
    const ChannelValues found = means.mean_over_pixel({12.5, 7.25});
    EXPECT_NEAR(found[0], 0.3125, 1e-3) << period;
    EXPECT_NEAR(found[1], 0.75, 1e-3) << period;
  }
}

// The mean over a parallelogram is exact where values are linear in the offset.
TEST(GradientMeans, AreExactBetweenStops) {
  Paint paint = rings(100.0, Spread::kPad);
  const GradientMeans means(paint);
  const ChannelValues found = means.mean_over({62.5, 0.0}, {2.0, 0.0}, {0.0, 1e-9});
  EXPECT_NEAR(found[0], 0.25, 1e-12);
  EXPECT_NEAR(found[1], 0.875, 1e-12);
  EXPECT_NEAR(means.mean_over({1e6, 0.0}, {2.0, 0.0}, {0.0, 1.0})[1], 0.75, 1e-12);
}

// A gradient with fine stops has no cutter.
TEST(GradientMeans, FineStopsCutNothing) {
  const Box2 box{{0.0, 0.0}, {512.0, 512.0}};
  EXPECT_TRUE(gradient_cutter(rings(0.5, Spread::kRepeat), box).empty());
  EXPECT_TRUE(gradient_cutter(rings(1e-6, Spread::kReflect), box).empty());
  EXPECT_FALSE(gradient_cutter(rings(100.0, Spread::kRepeat), box).empty());
  Paint dense = rings(100.0, Spread::kPad);
  EXPECT_FALSE(gradient_cutter(dense, box).empty());
  dense.stops.clear();
  for (int i = 0; i <= 1000; ++i) dense.stops.push_back({i / 1000.0, {i % 2 + 0.0, 0.0, 0.0, 0.0}});
  EXPECT_TRUE(gradient_cutter(dense, box).empty());
}

}  // namespace
}  // namespace prefilter
