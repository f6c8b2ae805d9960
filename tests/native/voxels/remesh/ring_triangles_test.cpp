// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/voxels/remesh/ring_triangles.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

namespace prefilter {
namespace {

using Triangles = std::vector<std::array<std::size_t, 3>>;

// All triangulations of the points from i to j.
std::vector<Triangles> all_ways(std::size_t i, std::size_t j) {
  if (j - i < 2) return {{}};
  std::vector<Triangles> ways;
  for (std::size_t k = i + 1; k < j; ++k) {
    for (const Triangles& left : all_ways(i, k)) {
      for (const Triangles& right : all_ways(k, j)) {
        Triangles way = {{i, k, j}};
        way.insert(way.end(), left.begin(), left.end());
        way.insert(way.end(), right.begin(), right.end());
        ways.push_back(way);
      }
    }
  }
  return ways;
}

double smallest_angle(const Vector3& a, const Vector3& b, const Vector3& c) {
  const std::array<Vector3, 3> p = {a, b, c};
  double least = 180.0;
  for (std::size_t i = 0; i < 3; ++i) {
    const Vector3 u = p[(i + 1) % 3] - p[i];
    const Vector3 v = p[(i + 2) % 3] - p[i];
    least = std::min(least, std::atan2(length(cross(u, v)), dot(u, v)) * 180.0 / std::numbers::pi);
  }
  return least;
}

struct Judged {
  bool is_allowed = true;
  double fault = 0.0;
  double sides = 0.0;
};

// Judges by angles, where the library uses squared sines.
Judged judged(const std::vector<Vector3>& points, const Triangles& way, double least, double unit) {
  Judged result;
  for (const auto& [i, k, j] : way) {
    const Vector3 normal = cross(points[k] - points[i], points[j] - points[i]);
    if (!(normal[2] > least * length(normal))) result.is_allowed = false;
    const double angle = smallest_angle(points[i], points[k], points[j]);
    if (angle < 16.0) {
      const double share =
          std::sin(angle * std::numbers::pi / 180.0) / std::sin(16.0 * std::numbers::pi / 180.0);
      result.fault += 2.0 - share * share;
    }
    double squares = 0.0;
    for (const auto& [a, b] : {std::pair{i, k}, {k, j}, {i, j}}) {
      squares += dot(points[a] - points[b], points[a] - points[b]);
    }
    result.sides += unit * normal[2] * unit * squares;
  }
  return result;
}

TEST(RingTriangles, AreTheBestOfAllTriangulations) {
  std::mt19937 random(9);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  int found_count = 0;
  int refused = 0;
  int faulty = 0;
  for (int round = 0; round < 600; ++round) {
    const std::size_t count = 3 + random() % 6;
    std::vector<Vector3> points;
    for (std::size_t i = 0; i < count; ++i) {
      const double angle = 2.0 * std::numbers::pi *
                           (static_cast<double>(i) + 0.4 * uniform(random)) /
                           static_cast<double>(count);
      const double radius = 1.0 + 0.7 * uniform(random);
      points.push_back({radius * std::cos(angle), radius * std::sin(angle), 0.2 * uniform(random)});
    }
    const double least = round % 2 == 0 ? 0.94 : 0.5;
    constexpr double kUnit = 0.3;
    RingTriangles made;
    const bool is_found = triangulate_ring(points, {0.0, 0.0, 1.0}, kUnit, least, &made);
    double best = std::numeric_limits<double>::infinity();
    for (const Triangles& way : all_ways(0, count - 1)) {
      const Judged one = judged(points, way, least, kUnit);
      if (one.is_allowed) best = std::min(best, 1e3 * one.fault + one.sides);
    }
    ASSERT_EQ(is_found, std::isfinite(best)) << round;
    ++(is_found ? found_count : refused);
    if (!is_found) continue;
    ASSERT_EQ(made.count, count - 2);
    const Triangles way(made.triangles.begin(),
                        made.triangles.begin() + static_cast<std::ptrdiff_t>(made.count));
    const Judged one = judged(points, way, least, kUnit);
    EXPECT_TRUE(one.is_allowed);
    EXPECT_NEAR(1e3 * one.fault + one.sides, best, 1e-3);  // kMinWidth is a float
    EXPECT_NEAR(made.fault, one.fault, 1e-6);
    faulty += one.fault > 0.0 ? 1 : 0;
  }
  EXPECT_GT(found_count, 50);
  EXPECT_GT(refused, 20);
  EXPECT_GT(faulty, 20);
}

}  // namespace
}  // namespace prefilter
