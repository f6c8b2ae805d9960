// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/geometry/spatial/nearest_neighbors.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <set>

#include "prefilter/base/error.h"

namespace prefilter {
namespace {

std::vector<Vector3> random_points(unsigned seed, std::size_t count, const Vector3& size) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  std::vector<Vector3> points(count);
  for (Vector3& p : points) {
    p = {size[0] * uniform(random), size[1] * uniform(random), size[2] * uniform(random)};
  }
  return points;
}

double square(const Vector3& a, const Vector3& b) { return dot(a - b, a - b); }

// Compares with a search through all distinct positions.
void expect_nearest(const std::vector<Vector3>& points, std::size_t count) {
  const NeighborSearch search(points, prefilter::Run(1));
  const std::set<Vector3> distinct(points.begin(), points.end());
  ASSERT_EQ(search.positions().size(), distinct.size());
  Neighbors found;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::uint32_t place = search.places()[i];
    ASSERT_EQ(search.positions()[place], points[i]);
    search.find(place, count, &found);
    std::vector<double> wanted;
    for (const Vector3& p : distinct) wanted.push_back(square(p, points[i]));
    std::sort(wanted.begin(), wanted.end());
    wanted.resize(std::min(count, wanted.size()));
    EXPECT_EQ(std::vector<double>(found.squares().begin(), found.squares().end()), wanted);
    ASSERT_EQ(found.places().size(), wanted.size());
    for (std::size_t k = 0; k < wanted.size(); ++k) {
      EXPECT_EQ(square(search.positions()[found.places()[k]], points[i]), found.squares()[k]);
    }
    const std::set<std::uint32_t> places(found.places().begin(), found.places().end());
    EXPECT_EQ(places.size(), wanted.size());
    EXPECT_TRUE(places.contains(place));
  }
}

TEST(NeighborSearch, AgreesWithASearchThroughAll) {
  for (const std::size_t count : {1U, 5U, 16U, 100U}) {
    expect_nearest(random_points(1, 300, {1, 1, 1}), count);
    expect_nearest(random_points(2, 300, {1, 1, 0}), count);
    expect_nearest(random_points(3, 300, {1, 0, 0}), count);
  }
}

TEST(NeighborSearch, TakesGridsWhereManyDistancesAreTheSame) {
  std::vector<Vector3> points;
  for (int i = 0; i < 8 * 8 * 8; ++i) {
    points.push_back(
        {static_cast<double>(i % 8), static_cast<double>(i / 8 % 8), static_cast<double>(i / 64)});
  }
  expect_nearest(points, 16);
}

TEST(NeighborSearch, MergesCopies) {
  std::vector<Vector3> points = random_points(4, 40, {1, 1, 1});
  for (int i = 0; i < 400; ++i) points.push_back(points[static_cast<std::size_t>(i * 7 % 40)]);
  points.push_back({0.0, 0.0, 0.0});
  points.push_back({-0.0, 0.0, -0.0});
  const NeighborSearch search(points, prefilter::Run(2));
  EXPECT_EQ(search.positions().size(), 41U);
  EXPECT_EQ(search.places()[440], search.places()[441]);
  // Different points with the same key, because a distant point makes the curve coarse.
  std::vector<Vector3> close = random_points(5, 200, {1e-9, 1e-9, 1e-9});
  for (int i = 0; i < 200; ++i) close.push_back(close[static_cast<std::size_t>(i)]);
  close.push_back({1.0, 1.0, 1.0});
  expect_nearest(close, 7);
}

TEST(NeighborSearch, ManyCopiesAreFast) {
  std::vector<Vector3> points(300000, Vector3{1.0, 2.0, 3.0});
  for (std::size_t i = 0; i < points.size(); i += 2) points[i][0] = 1.0 + 1e-12;
  points.push_back({9.0, 9.0, 9.0});
  const NeighborSearch search(points, prefilter::Run(2));
  EXPECT_EQ(search.positions().size(), 3U);
}

TEST(NeighborSearch, LeavesOutNonfinitePoints) {
  std::vector<Vector3> points = random_points(6, 10, {1, 1, 1});
  points[3][1] = NAN;
  points[5][2] = INFINITY;
  points[7][0] = -1e200;
  const NeighborSearch search(points, prefilter::Run(1));
  EXPECT_EQ(search.positions().size(), 7U);
  for (const std::size_t i : {3U, 5U, 7U}) {
    EXPECT_EQ(search.places()[i], NeighborSearch::kNowhere);
  }
  const std::vector<Vector3> none(3, Vector3{NAN, 0.0, 0.0});
  EXPECT_TRUE(NeighborSearch(none, prefilter::Run(1)).positions().empty());
  EXPECT_TRUE(NeighborSearch({}, prefilter::Run(1)).positions().empty());
}

TEST(NeighborSearch, TakesLargeAndSmallNumbers) {
  expect_nearest(random_points(7, 100, {1e150, 1e150, 1e150}), 9);
  expect_nearest(random_points(8, 100, {1e-100, 1e-100, 1e-100}), 9);
  std::vector<Vector3> far = random_points(9, 100, {1, 1, 1});
  far.push_back({1e100, 0.0, 0.0});
  expect_nearest(far, 9);
}

}  // namespace
}  // namespace prefilter
