// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/points/paint_texture.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "prefilter/base/error.h"

namespace prefilter {
namespace {

// A square in space whose texture covers part of the unit square.
Surface square(double low, double high) {
  const std::vector<Vector3> positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  const std::vector<std::array<std::int32_t, 3>> triangles = {{0, 1, 2}, {0, 2, 3}};
  const std::vector<double> uvs = {low, low, high, low,  high, high,
                                   low, low, high, high, low,  high};
  TexturedMesh mesh;
  mesh.mesh = {positions, triangles};
  mesh.uvs = uvs.data();
  return make_surface(mesh);
}

struct Points {
  std::vector<Vector3> places;
  std::vector<float> values;
};

template <typename Color>
Points points_of(int count, const Color& color) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  Points points;
  for (int i = 0; i < count; ++i) {
    const double x = uniform(random);
    const double y = uniform(random);
    points.places.push_back({x, y, 0.01 * uniform(random)});
    points.values.push_back(static_cast<float>(color(x, y)));
  }
  return points;
}

// The same bounded least squares by dense normal equations, one unknown at a time.
std::vector<double> dense_solution(const Points& points, int side, double smoothing) {
  const auto n = static_cast<std::size_t>(side) * static_cast<std::size_t>(side);
  std::vector<double> matrix(n * n);
  std::vector<double> right(n);
  const auto add_row = [&](const std::array<std::size_t, 4>& at, const std::array<double, 4>& row,
                           double value, double weight) {
    for (std::size_t i = 0; i < 4; ++i) {
      right[at[i]] += weight * row[i] * value;
      for (std::size_t j = 0; j < 4; ++j) matrix[at[i] * n + at[j]] += weight * row[i] * row[j];
    }
  };
  const auto corners = [&](int column, int row) {
    std::array<std::size_t, 4> at;
    for (int k = 0; k < 4; ++k) {
      const int x = std::clamp(column + k % 2, 0, side - 1);
      const int y = std::clamp(row + k / 2, 0, side - 1);
      at[static_cast<std::size_t>(k)] = static_cast<std::size_t>(y * side + x);
    }
    return at;
  };
  for (std::size_t i = 0; i < points.places.size(); ++i) {
    const double x = points.places[i][0] * side - 0.5;
    const double y = points.places[i][1] * side - 0.5;
    const double a = x - std::floor(x);
    const double b = y - std::floor(y);
    add_row(corners(static_cast<int>(std::floor(x)), static_cast<int>(std::floor(y))),
            {(1 - a) * (1 - b), a * (1 - b), (1 - a) * b, a * b},
            static_cast<double>(points.values[i]), 1.0);
  }
  // The squared gradient of a bilinear cell, exactly, by two-point Gaussian quadrature along each
  // axis.
  for (int row = 0; row + 1 < side; ++row) {
    for (int column = 0; column + 1 < side; ++column) {
      for (const double at : {0.5 - std::sqrt(1.0 / 12.0), 0.5 + std::sqrt(1.0 / 12.0)}) {
        add_row(corners(column, row), {at - 1, 1 - at, -at, at}, 0.0, 0.5 * smoothing);
        add_row(corners(column, row), {at - 1, -at, 1 - at, at}, 0.0, 0.5 * smoothing);
      }
    }
  }
  const auto bounds = std::minmax_element(points.values.begin(), points.values.end());
  const double low = static_cast<double>(*bounds.first);
  const double high = static_cast<double>(*bounds.second);
  std::vector<double> solution(n, 0.5);
  for (int sweep = 0; sweep < 20000; ++sweep) {
    for (std::size_t i = 0; i < n; ++i) {
      double sum = right[i];
      for (std::size_t j = 0; j < n; ++j) {
        if (j != i) sum -= matrix[i * n + j] * solution[j];
      }
      solution[i] = std::clamp(sum / matrix[i * n + i], low, high);
    }
  }
  return solution;
}

TEST(PaintTexture, SolvesTheLeastSquares) {
  constexpr int kTexels = 8;
  const auto color = [](double x, double y) {
    return 0.5 + 0.4 * std::sin(5 * x) * std::cos(4 * y);
  };
  for (const int count : {20, 500}) {
    const Points points = points_of(count, color);
    PaintOptions options;
    options.width = kTexels;
    options.height = kTexels;
    const PaintedTexture found =
        paint_texture(square(0.0, 1.0), points.places, points.values, 1, options);
    EXPECT_EQ(found.points, points.places.size());
    const std::vector<double> expected = dense_solution(points, kTexels, options.smoothing);
    for (std::size_t i = 0; i < expected.size(); ++i) {
      EXPECT_NEAR(static_cast<double>(found.image.data[i]), expected[i], 1e-3);
    }
  }
}

TEST(PaintTexture, OfALinearColorIsLinear) {
  // Smoothness hardly counts where samples determine the texels; the gutter repeats the adjacent
  // texels.
  const Points points =
      points_of(20000, [](double x, double y) { return 0.2 + 0.3 * x + 0.4 * y; });
  PaintOptions options;
  options.width = 32;
  options.height = 16;
  options.smoothing = 1e-4;
  const Image image =
      paint_texture(square(0.25, 0.75), points.places, points.values, 1, options).image;
  for (int y = 0; y < 16; ++y) {
    for (int x = 0; x < 32; ++x) {
      const double u = std::clamp(2.0 * ((x + 0.5) / 32 - 0.25), 0.0, 1.0);
      const double v = std::clamp(2.0 * ((y + 0.5) / 16 - 0.25), 0.0, 1.0);
      const bool is_inside = u > 0.0 && u < 1.0 && v > 0.0 && v < 1.0;
      EXPECT_NEAR(static_cast<double>(*image.texel(x, y)), 0.2 + 0.3 * u + 0.4 * v,
                  is_inside ? 5e-3 : 0.2);
    }
  }
}

TEST(PaintTexture, IgnoresPointsThatAreFarOrNotFinite) {
  Points points = points_of(400, [](double, double) { return 0.25; });
  points.places.push_back({0.5, 0.5, 3.0});
  points.values.push_back(1.0F);
  points.places.push_back({std::numeric_limits<double>::quiet_NaN(), 0.0, 0.0});
  points.values.push_back(1.0F);
  points.places.push_back({0.5, 0.5, 0.0});
  points.values.push_back(std::numeric_limits<float>::infinity());
  PaintOptions options;
  options.width = 4;
  options.height = 4;
  options.reach = 0.5;
  const PaintedTexture found =
      paint_texture(square(0.0, 1.0), points.places, points.values, 1, options);
  EXPECT_EQ(found.points, 400U);
  for (const float value : found.image.data) EXPECT_EQ(value, 0.25F);
  options.reach = std::nullopt;
  EXPECT_EQ(paint_texture(square(0.0, 1.0), points.places, points.values, 1, options).points, 401U);
}

TEST(PaintTexture, Refuses) {
  const Points points = points_of(10, [](double, double) { return 0.5; });
  PaintOptions options;
  const auto paint = [&] {
    return paint_texture(square(0.0, 1.0), points.places, points.values, 1, options);
  };
  EXPECT_THROW(paint(), Error);
  options.width = options.height = 8;
  EXPECT_EQ(paint().points, 10U);
  for (const double smoothing : {0.0, -1.0, 1e7, std::numeric_limits<double>::quiet_NaN()}) {
    options.smoothing = smoothing;
    EXPECT_THROW(paint(), Error);
  }
  options.smoothing = 1.0;
  options.reach = 1e-9;
  EXPECT_THROW(paint(), Error);
  options.reach = std::nullopt;
  EXPECT_THROW(paint_texture(square(0.0, 1.0), points.places, points.values, 2, options), Error);
  options.run = prefilter::Run([](double) { return false; });
  EXPECT_THROW(paint(), Error);
}

}  // namespace
}  // namespace prefilter
