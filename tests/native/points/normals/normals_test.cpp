// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/points/normals.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "prefilter/base/error.h"
#include "prefilter/points/face_normals.h"
#include "prefilter/points/height_field.h"

namespace prefilter {
namespace {

std::vector<Vector3> sphere(unsigned seed, std::size_t count) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  std::vector<Vector3> points(count);
  for (Vector3& p : points) {
    p = {normal(random), normal(random), normal(random)};
    const double size = length(p);
    for (double& x : p) x /= size;
  }
  return points;
}

TEST(EstimateNormals, OfASpherePointOutward) {
  const std::vector<Vector3> points = sphere(1, 5000);
  const std::vector<Vector3> normals =
      estimate_normals(points, 16, {}, NormalSide::kOutward, prefilter::Run(2));
  for (std::size_t i = 0; i < points.size(); ++i) EXPECT_GT(dot(points[i], normals[i]), 0.98);
  EXPECT_EQ(estimate_normals(points, 16, {}, NormalSide::kOutward, prefilter::Run(1)), normals);
}

TEST(EstimateNormals, PointToTheViewpoint) {
  const std::vector<Vector3> points = sphere(2, 2000);
  const std::vector<Vector3> inside = {{0.2, 0.1, -0.1}};
  const std::vector<Vector3> normals =
      estimate_normals(points, 16, inside, NormalSide::kOutward, prefilter::Run(2));
  for (std::size_t i = 0; i < points.size(); ++i) EXPECT_LT(dot(points[i], normals[i]), -0.95);
}

TEST(EstimateNormals, PointUp) {
  const std::vector<Vector3> points = sphere(4, 5000);
  const std::vector<Vector3> normals =
      estimate_normals(points, 16, {}, NormalSide::kUp, prefilter::Run(2));
  std::size_t level = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const bool is_level = std::abs(normals[i][2]) < 0.17;
    level += is_level ? 1 : 0;
    EXPECT_TRUE(is_level || normals[i][2] > 0.0);
  }
  EXPECT_GT(level, 100U);
}

TEST(HeightField, AcceptsSheetsAndRejectsSolids) {
  std::vector<Vector3> points = sphere(5, 4000);
  EXPECT_FALSE(is_height_field(points, prefilter::Run()));
  for (Vector3& p : points) p[2] = 0.3 * p[0] * p[1];
  EXPECT_TRUE(is_height_field(points, prefilter::Run()));
  points.resize(99);
  EXPECT_FALSE(is_height_field(points, prefilter::Run()));
}

TEST(EstimateNormals, AcceptAnyPoints) {
  std::vector<Vector3> points = sphere(3, 300);
  for (std::size_t i = 0; i < 300; ++i) points.push_back(points[i % 7]);
  points.push_back({NAN, 0.0, 0.0});
  points.push_back({1e150, -1e150, 1e150});
  points.push_back({1e-300, 0.0, 0.0});
  for (int i = 0; i < 100; ++i) points.push_back({5.0 + i, 0.0, 0.0});
  const std::vector<Vector3> normals =
      estimate_normals(points, 1000, {}, NormalSide::kOutward, prefilter::Run(2));
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_NEAR(length(normals[i]), i == 600 ? 0.0 : 1.0, 1e-12);
  }
}

TEST(GridNormals, SkipDepthDiscontinuities) {
  constexpr std::int64_t kSide = 20;
  std::vector<Vector3> points;
  RangeGrid grid{kSide, kSide, {}};
  for (std::int64_t i = 0; i < kSide * kSide; ++i) {
    const auto x = static_cast<double>(i % kSide);
    points.push_back({x, static_cast<double>(i / kSide), x < 10.0 ? 0.0 : -50.0});
    grid.points.push_back(i);
  }
  points[42][0] = NAN;
  grid.points[77] = -1;
  const GridNormals found = grid_normals(points, grid, {}, prefilter::Run());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const bool has_normal = i != 42 && i != 77;
    EXPECT_EQ(found.normals[i], (Vector3{0.0, 0.0, has_normal ? 1.0 : 0.0}));
    EXPECT_EQ(found.weights[i] > 0.0F, has_normal);
  }
  grid.points[3] = kSide * kSide;
  EXPECT_THROW(grid_normals(points, grid, {}, prefilter::Run()), Error);
  grid.points.pop_back();
  EXPECT_THROW(grid_normals(points, grid, {}, prefilter::Run()), Error);
}

}  // namespace
}  // namespace prefilter
