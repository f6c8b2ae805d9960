// SPDX-License-Identifier: GPL-3.0-or-later

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "prefilter/base/error.h"
#include "prefilter/points/align_scans.h"
#include "prefilter/points/outliers.h"
#include "prefilter/points/subsample.h"

namespace prefilter {
namespace {

// Points of an ellipsoid, whose normals differ from a sphere's.
std::vector<Vector3> ellipsoid(std::size_t count, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  std::vector<Vector3> points;
  while (points.size() < count) {
    const Vector3 point = {normal(random), normal(random), normal(random)};
    const double size = length(point);
    points.push_back({point[0] / size, 1.4 * point[1] / size, 0.7 * point[2] / size});
  }
  return points;
}

std::vector<Vector3> normals_of(const std::vector<Vector3>& points) {
  std::vector<Vector3> normals;
  for (const Vector3& p : points) normals.push_back({p[0], p[1] / 1.96, p[2] / 0.49});
  return normals;
}

double nearest_square(const std::vector<Vector3>& points, const std::vector<std::int64_t>& among,
                      std::int64_t own) {
  double least = std::numeric_limits<double>::infinity();
  for (const std::int64_t other : among) {
    const Vector3 offset =
        points[static_cast<std::size_t>(other)] - points[static_cast<std::size_t>(own)];
    if (other != own) least = std::min(least, dot(offset, offset));
  }
  return least;
}

TEST(Subsample, PoissonDisksAreApartAndCover) {
  std::vector<Vector3> points = ellipsoid(600, 1);
  points.push_back({std::nan(""), 0.0, 0.0});
  points.push_back(points[0]);
  const std::vector<std::int64_t> kept =
      subsample(points, 0.3, Subsampling::kPoisson, prefilter::Run(2));
  for (std::int64_t i = 0; i < 600; ++i) {
    const bool is_kept = std::find(kept.begin(), kept.end(), i) != kept.end();
    const double square = nearest_square(points, kept, i);
    EXPECT_EQ(square >= 0.09, is_kept);
  }
  EXPECT_LT(kept.back(), 600);
}

TEST(Subsample, GridsHaveOnePointInEachCell) {
  const std::vector<Vector3> points = {{0, 0, 0}, {0.4, 0, 0}, {0.9, 0, 0}, {1.5, 0, 0}};
  EXPECT_EQ(subsample(points, 1.0, Subsampling::kGrid, prefilter::Run(1)),
            (std::vector<std::int64_t>{1, 3}));
  EXPECT_THROW(subsample(points, 0.0, Subsampling::kGrid, prefilter::Run(1)), Error);
  EXPECT_TRUE(subsample({}, 1.0, Subsampling::kGrid, prefilter::Run(1)).empty());
}

TEST(FindOutliers, FindsIsolatedPoints) {
  std::vector<Vector3> points = ellipsoid(2000, 2);
  points.push_back({3.0, 0.0, 0.0});
  const std::vector<bool> found = find_outliers(points, 16, 2.5, prefilter::Run(2));
  EXPECT_TRUE(found[2000]);
  EXPECT_EQ(std::count(found.begin(), found.end(), true), 1);
  EXPECT_THROW(find_outliers(points, 2, 2.0, prefilter::Run(1)), Error);
}

TEST(AlignScans, UndoesASmallMotion) {
  const std::vector<Vector3> first = ellipsoid(4000, 3);
  std::vector<Vector3> second = ellipsoid(4000, 4);
  std::vector<Vector3> normals = normals_of(second);
  const double c = std::cos(0.05);
  const double s = std::sin(0.05);
  RigidMotion motion;
  motion.rows = {Vector3{c, -s, 0}, Vector3{s, c, 0}, Vector3{0, 0, 1}};
  motion.shift = {0.03, -0.02, 0.01};
  for (Vector3& point : second) point = moved(motion, point);
  for (Vector3& normal : normals) normal = turned(motion, normal);
  const std::vector<Vector3> first_normals = normals_of(first);
  const ScanView scans[] = {{first, first_normals}, {second, normals}};
  const Alignment found = align_scans(scans, AlignOptions{});
  const RigidMotion both = then(motion, found.motions[1]);
  for (const Vector3& point : {Vector3{1, 0, 0}, Vector3{0, 1, 0}, Vector3{0, 0, 1}}) {
    EXPECT_LT(length(moved(both, point) - point), 3e-3);
    EXPECT_EQ(moved(found.motions[0], point), point);
    EXPECT_LT(length(moved_back(both, moved(both, point)) - point), 1e-12);
  }
  EXPECT_LT(found.after, 0.5 * found.before);
  EXPECT_THROW(align_scans(std::span(scans).first(1), AlignOptions{}), Error);
}

}  // namespace
}  // namespace prefilter
