// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/points/reconstruct/automatic_depth.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "points/reconstruct/test_cloud.h"
#include "prefilter/voxels/voxelize.h"

namespace prefilter {
namespace {

constexpr double kRadius = 0.35;
constexpr double kArea = 4.0 * 3.14159265358979 * kRadius * kRadius;

ThinnedPoints thinned(const std::vector<Vector3>& points, std::size_t batch = 1000) {
  ThinnedPoints some;
  std::vector<ThinnedPoints::Entry> entries;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const ThinnedPoints::Entry entry = ThinnedPoints::entry_of(points[i]);
    if (some.keeps(entry)) entries.push_back(entry);
    if (entries.size() < batch && i + 1 < points.size()) continue;
    some.add(entries);
    entries.clear();
  }
  some.finish();
  return some;
}

Box box_of(const std::vector<Vector3>& points) {
  Box box = kEmptyBox;
  for (const Vector3& point : points) box.include(point);
  return box;
}

int depth_of(const std::vector<Vector3>& points) {
  return automatic_depth(thinned(points), box_of(points), prefilter::Run(1));
}

// Expected number of points per cell face if they are spread evenly.
double points_a_face(double count, const Box& box, int depth) {
  const double cell = std::ldexp(cube_around(box, depth).size(0), -depth);
  return count / kArea * cell * cell;
}

TEST(AutomaticDepth, IsTheDeepestWithOnePointPerFaceForEvenPoints) {
  int checked = 0;
  for (int count = 300; count < 400000; count += count / 3) {
    const std::vector<Vector3> points = testing::sphere_cloud(count, kRadius).points;
    const Box box = box_of(points);
    int wanted = 1;
    while (points_a_face(count, box, wanted + 1) >= 1.0) ++wanted;
    // Where two depths come equally close to one point per face, either may be chosen.
    if (points_a_face(count, box, wanted) < 1.25) continue;
    if (points_a_face(count, box, wanted + 1) > 0.9) continue;
    EXPECT_EQ(depth_of(points), wanted) << count;
    ++checked;
  }
  EXPECT_GE(checked, 12);
}

TEST(AutomaticDepth, RisesByHalfOnAverageWhenPointsDouble) {
  int rise = 0;
  for (int step = 0; step < 8; ++step) {
    const double count = 6000.0 * std::pow(4.0, step / 8.0);
    const auto depth = [&](double times) {
      return depth_of(testing::sphere_cloud(static_cast<int>(times * count), kRadius).points);
    };
    rise += depth(2.0) - depth(1.0);
    EXPECT_EQ(depth(16.0), depth(1.0) + 2) << count;
  }
  EXPECT_NEAR(rise, 4, 1);
}

TEST(AutomaticDepth, IsTheSameForAnyOrderCopiesAndThreads) {
  std::vector<Vector3> points = testing::sphere_cloud(20000).points;
  const int depth = depth_of(points);
  const Box box = box_of(points);
  EXPECT_EQ(automatic_depth(thinned(points), box, prefilter::Run(7)), depth);
  const std::vector<Vector3> once = points;
  for (int k = 0; k < 20; ++k) points.insert(points.end(), once.begin(), once.end());
  std::shuffle(points.begin(), points.end(), std::mt19937(3));
  EXPECT_EQ(depth_of(points), depth);
}

TEST(AutomaticDepth, IgnoresASmallDenserPart) {
  std::vector<Vector3> points = testing::sphere_cloud(8000).points;
  const int depth = depth_of(points);
  for (const Vector3& point : testing::sphere_cloud(600000).points) {
    if (point[2] > 0.5 + 0.8 * 0.35) points.push_back(point);  // A tenth of the area.
  }
  ASSERT_GT(points.size(), 60000U);
  EXPECT_EQ(depth_of(points), depth);
}

TEST(AutomaticDepth, IgnoresPointsOutsideTheBox) {
  std::vector<Vector3> points = testing::sphere_cloud(8000).points;
  const Box box = box_of(points);
  const int depth = automatic_depth(thinned(points), box, prefilter::Run(1));
  for (int k = 0; k < 6000; ++k) points.push_back({9.0, 9.0 + k, 9.0});
  EXPECT_EQ(automatic_depth(thinned(points), box, prefilter::Run(1)), depth);
}

TEST(AutomaticDepth, IsValidForAnyPoints) {
  const auto is_depth = [](const std::vector<Vector3>& points) {
    const int depth = depth_of(points);
    EXPECT_GE(depth, 1);
    EXPECT_LE(depth, kMaxTreeDepth);
    return depth;
  };
  EXPECT_EQ(is_depth({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}), 1);
  is_depth({{0, 0, 0}, {1e300, 0, 0}, {0, 1e-300, 0}});
  is_depth({{0, 0, 0}, {1e-300, 0, 0}, {0, -0.0, 0}});
  std::vector<Vector3> line;
  for (int k = 0; k < 5000; ++k) line.push_back({0.001 * k, 0.0, 0.0});
  is_depth(line);
  std::vector<Vector3> sphere = testing::sphere_cloud(5000).points;
  const int depth = is_depth(sphere);
  for (const double scale : {1e-140, 1e140}) {
    std::vector<Vector3> scaled = sphere;
    for (Vector3& point : scaled) {
      for (double& x : point) x *= scale;
    }
    EXPECT_EQ(is_depth(scaled), depth) << scale;
  }
}

TEST(ThinnedPoints, HaveTheSmallestHashesInAnyOrder) {
  std::vector<Vector3> points = testing::sphere_cloud(700000).points;
  std::vector<std::uint64_t> numbers;
  for (const Vector3& point : points) numbers.push_back(ThinnedPoints::entry_of(point).hash);
  std::sort(numbers.begin(), numbers.end());
  const auto up_to = [&](std::uint64_t largest) {
    return static_cast<std::size_t>(std::upper_bound(numbers.begin(), numbers.end(), largest) -
                                    numbers.begin());
  };
  std::uint64_t largest = ~std::uint64_t{0};
  double share = 1.0;
  for (; up_to(largest) > ThinnedPoints::kMaxEntries; largest /= 2) share *= 2.0;
  for (const std::size_t batch : {std::size_t{7}, std::size_t{100000}, points.size()}) {
    std::shuffle(points.begin(), points.end(), std::mt19937(5));
    const ThinnedPoints some = thinned(points, batch);
    EXPECT_EQ(some.share(), share);
    ASSERT_EQ(some.entries().size(), up_to(largest));
    for (std::size_t i = 0; i < some.entries().size(); ++i) {
      ASSERT_EQ(some.entries()[i].hash, numbers[i]);
    }
  }
}

}  // namespace
}  // namespace prefilter
