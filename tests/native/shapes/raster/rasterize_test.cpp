// SPDX-License-Identifier: GPL-3.0-or-later

// Whole images in C++, so that they run under the sanitizers: areas, laws, and degenerate inputs.
#include "prefilter/shapes/rasterize.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <random>
#include <vector>

#include "prefilter/base/error.h"
#include "prefilter/shapes/raster/cell_filter.h"

namespace prefilter {
namespace {

Outline circle(Point2 center, double radius) {
  constexpr Point2 kAxes[] = {{1, 0}, {0, 1}, {-1, 0}, {0, -1}, {1, 0}};
  Outline outline;
  outline.move_to(center + radius * kAxes[0]);
  for (int k = 0; k < 4; ++k) {
    outline.conic_to(center + radius * (kAxes[k] + kAxes[k + 1]), std::sqrt(0.5),
                     center + radius * kAxes[k + 1]);
  }
  outline.close();
  return outline;
}

Outline polygon(const std::vector<Point2>& corners) {
  Outline outline;
  outline.move_to(corners.front());
  for (std::size_t i = 1; i < corners.size(); ++i) outline.line_to(corners[i]);
  outline.close();
  return outline;
}

RasterOptions options_of(int width, int height, std::string_view filter) {
  RasterOptions options;
  options.width = width;
  options.height = height;
  options.filter = filter;
  options.overlap = Overlap::kAdd;
  options.run = prefilter::Run(1);
  return options;
}

std::vector<float> values_of(const std::vector<Shape>& shapes, const RasterOptions& options) {
  const Image image = rasterize(shapes, options);
  return {image.texel(0, 0), image.texel(0, 0) + static_cast<std::ptrdiff_t>(image.width) *
                                                     image.height * image.channels};
}

double sum_of(const std::vector<float>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0);
}

TEST(Rasterize, KeepsAreas) {
  Shape shape;
  shape.outline = circle({20.3, 17.1}, 11.0);
  // Filters that sum to 1 around every point.
  for (const std::string_view filter : {"box", "tent", "bspline2", "mitchell"}) {
    const double sum = sum_of(values_of({shape}, options_of(48, 40, filter)));
    EXPECT_NEAR(sum, std::numbers::pi * 121.0, 1e-4) << filter;
  }
}

TEST(Rasterize, IsConstantDeepInsideAShape) {
  Shape shape;
  shape.outline = circle({3.0, 2.0}, 1e6);
  shape.paint.constant[0] = 0.3;
  for (const std::string_view filter : raster_filters()) {
    for (const float value : values_of({shape}, options_of(7, 5, filter))) {
      ASSERT_EQ(value, 0.3F) << filter;
    }
  }
}

// Curves of many kinds, over several bands of rows and beyond all sides of the image.
std::vector<Shape> scene() {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> place(-30.0, 330.0);
  std::vector<Shape> shapes;
  for (const int degree : {1, 2, 3, 4, 7, 60}) {
    Shape shape;
    shape.outline.move_to({place(random), place(random)});
    for (int k = 0; k < (degree < 10 ? 3 : 1); ++k) {
      std::vector<Point2> points;
      for (int i = 0; i < degree; ++i) points.push_back({place(random), place(random)});
      shape.outline.curve_to(points);
    }
    for (const double weight : {1e-6, 0.3, 40.0, 1e6}) {
      shape.outline.conic_to({place(random), place(random)}, weight,
                             {place(random), place(random)});
    }
    shape.fill_rule = degree % 2 == 0 ? FillRule::kEvenOdd : FillRule::kNonzero;
    shapes.push_back(shape);
  }
  shapes[1].paint.kind = Paint::Kind::kLinear;
  shapes[1].paint.along_x[0] = 0.003;
  shapes[2].paint.kind = Paint::Kind::kLinearStops;
  shapes[2].paint.stops = {{0.0, {0.2}}, {0.4, {0.9}}, {1.0, {0.5}}};
  shapes[2].paint.end = {100.0, 50.0};
  shapes[2].paint.spread = Spread::kReflect;
  shapes[3].paint.kind = Paint::Kind::kRadialStops;
  shapes[3].paint.stops = shapes[2].paint.stops;
  shapes[3].paint.start = shapes[3].paint.end = {150.0, 150.0};
  shapes[3].paint.end_radius = 80.0;
  shapes[3].paint.spread = Spread::kRepeat;
  return shapes;
}

TEST(Rasterize, GivesTheSameWithAnyNumberOfThreads) {
  const std::vector<Shape> shapes = scene();
  for (const std::string_view filter : {"box", "mitchell", "radial2"}) {
    RasterOptions options = options_of(50, 300, filter);
    const std::vector<float> one = values_of(shapes, options);
    for (const float value : one) ASSERT_TRUE(std::isfinite(value));
    options.run = prefilter::Run(3);
    EXPECT_EQ(values_of(shapes, options), one) << filter;
  }
}

TEST(Rasterize, AcceptsShapesWithoutArea) {
  std::vector<Shape> shapes(6);
  shapes[1].outline.move_to({1.0, 1.0});
  shapes[2].outline = polygon({{1.0, 1.0}});
  shapes[3].outline = polygon({{1.0, 1.0}, {4.0, 3.0}});
  shapes[4].outline.move_to({2.0, 2.0});
  shapes[4].outline.curve_to(std::vector<Point2>(60, {2.0, 2.0}));
  shapes[5].outline.move_to({2.0, 2.0});
  shapes[5].outline.conic_to({2.0, 2.0}, 1e6, {2.0, 2.0});
  for (const std::string_view filter : raster_filters()) {
    for (const float value : values_of(shapes, options_of(6, 5, filter))) ASSERT_EQ(value, 0.0F);
  }
}

TEST(Rasterize, TakesCoordinatesUpToTheLimit) {
  constexpr double kFar = 1e9;
  Shape shape;
  shape.outline = polygon({{2.5, -kFar}, {2.5, kFar}, {-kFar, kFar}, {-kFar, -kFar}});
  for (const std::string_view filter : raster_filters()) {
    const std::vector<float> values = values_of({shape}, options_of(9, 3, filter));
    EXPECT_NEAR(values[2], 0.5, 1e-6) << filter;
    EXPECT_EQ(values[8], 0.0F) << filter;
  }
}

TEST(Rasterize, RefusesInvalidCoordinates) {
  for (const double value : {std::numeric_limits<double>::quiet_NaN(),
                             std::numeric_limits<double>::infinity(), 1.001e9, -1.001e9}) {
    Shape shape;
    shape.outline = polygon({{1.0, 1.0}, {4.0, value}, {2.0, 3.0}});
    EXPECT_THROW(rasterize(std::vector<Shape>{shape}, options_of(4, 4, "box")), Error) << value;
  }
  EXPECT_THROW(rasterize({}, options_of(0, 4, "box")), Error);
  EXPECT_THROW(rasterize({}, options_of(4, -1, "box")), Error);
  EXPECT_THROW(rasterize({}, options_of(4, 4, "cubic")), Error);
}

TEST(Rasterize, TakesManyVerticesInsideOfAPixel) {
  std::vector<Point2> corners;
  constexpr int kCount = 20000;
  for (int k = 0; k < kCount; ++k) {
    const double angle = 2.0 * std::numbers::pi * k / kCount;
    corners.push_back({1.5 + 0.45 * std::cos(angle), 1.5 + 0.45 * std::sin(angle)});
  }
  Shape shape;
  shape.outline = polygon(corners);
  const double sum = sum_of(values_of({shape}, options_of(3, 3, "box")));
  EXPECT_NEAR(sum, std::numbers::pi * 0.45 * 0.45, 2e-6);
}

// Code is instantiated for degrees 0 to 3 and for the highest one; others are padded with zeros.
TEST(CellFilters, RasterizeKernelsOfAnyDegree) {
  for (int degree = 0; degree <= Kernel::kMostDegree; ++degree) {
    const Kernel kernel("any", 2.0, 1.0, degree, [](double x) { return std::exp(-x * x); });
    const CellFilter filter = cell_filter(kernel);
    EXPECT_EQ(filter.degree, degree <= 3 ? degree : Kernel::kMostDegree);
    for (int tap = 0; tap < filter.taps; ++tap) {
      for (const double x : {-0.4, -0.1, 0.3}) {
        double value = 0.0;
        for (int power = filter.degree; power >= 0; --power) {
          value = value * x + filter.along[tap * (filter.degree + 1) + power];
        }
        EXPECT_NEAR(value, kernel.value(tap + 0.5 + x - 2.0), 1e-13) << degree;
      }
    }
  }
}

}  // namespace
}  // namespace prefilter
