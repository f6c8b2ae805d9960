// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/geometry/nearest.h"

#include <gtest/gtest.h>

#include <cmath>
#include <ctime>
#include <random>

namespace prefilter {
namespace {

using Triangle = std::array<std::int64_t, 3>;

struct Soup {
  std::vector<Vector3> positions;
  std::vector<Triangle> triangles;

  InputMesh view() const { return {positions, triangles}; }
};

Soup random_soup(unsigned seed, int count, double size) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  Soup soup;
  for (int t = 0; t < count; ++t) {
    const Vector3 center = {uniform(random), uniform(random), uniform(random)};
    for (int i = 0; i < 3; ++i) {
      soup.positions.push_back({center[0] + size * uniform(random),
                                center[1] + size * uniform(random),
                                center[2] + size * uniform(random)});
    }
    soup.triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
  }
  return soup;
}

double distance(const Vector3& a, const Vector3& b) { return length(a - b); }

Vector3 point_at(const Soup& soup, const SurfacePoint& at) {
  Vector3 p{};
  for (int i = 0; i < 3; ++i) {
    const auto vertex =
        soup.triangles[static_cast<std::size_t>(at.triangle)][static_cast<std::size_t>(i)];
    for (int a = 0; a < 3; ++a)
      p[a] += at.weights[i] * soup.positions[static_cast<std::size_t>(vertex)][a];
  }
  return p;
}

// The distance to a triangle by projected gradient over two barycentric weights from a grid of
// starts: slow, but independent.
double slow_distance(const Vector3& p, const Vector3& a, const Vector3& b, const Vector3& c) {
  double best = 1e300;
  double best_v = 0.0;
  double best_w = 0.0;
  double step = 0.25;
  const auto at = [&](double v, double w) {
    Vector3 q;
    for (int x = 0; x < 3; ++x) q[x] = (1.0 - v - w) * a[x] + v * b[x] + w * c[x];
    return distance(p, q);
  };
  for (int round = 0; round < 45; ++round) {
    const double v0 = best_v;
    const double w0 = best_w;
    for (int i = -4; i <= 4; ++i) {
      for (int j = -4; j <= 4; ++j) {
        const double v = std::clamp(v0 + i * step, 0.0, 1.0);
        const double w = std::clamp(w0 + j * step, 0.0, 1.0 - v);
        const double d = at(v, w);
        if (d < best) {
          best = d;
          best_v = v;
          best_w = w;
        }
      }
    }
    step *= 0.6;
  }
  return best;
}

TEST(NearestPoints, AgreeWithASearchOverAllTriangles) {
  for (const double size : {0.02, 0.4}) {
    const Soup soup = random_soup(1, 40, size);
    const Soup asked = random_soup(2, 20, 0.5);
    const std::vector<SurfacePoint> found =
        nearest_points(asked.positions, soup.view(), prefilter::Run(1));
    for (std::size_t i = 0; i < found.size(); ++i) {
      double least = 1e300;
      for (const Triangle& t : soup.triangles) {
        least = std::min(
            least, slow_distance(asked.positions[i], soup.positions[static_cast<std::size_t>(t[0])],
                                 soup.positions[static_cast<std::size_t>(t[1])],
                                 soup.positions[static_cast<std::size_t>(t[2])]));
      }
      EXPECT_NEAR(found[i].distance, least, 1e-6);
      EXPECT_NEAR(distance(point_at(soup, found[i]), asked.positions[i]), found[i].distance, 1e-12);
      EXPECT_NEAR(found[i].weights[0] + found[i].weights[1] + found[i].weights[2], 1.0, 1e-12);
    }
  }
}

TEST(NearestPoints, AreTheSameForAnyThreadsAndOrder) {
  const Soup soup = random_soup(3, 5000, 0.05);
  Soup asked = random_soup(4, 4000, 0.5);
  const auto one = nearest_points(asked.positions, soup.view(), prefilter::Run(1));
  const auto two = nearest_points(asked.positions, soup.view(), prefilter::Run(2));
  std::reverse(asked.positions.begin(), asked.positions.end());
  auto reversed = nearest_points(asked.positions, soup.view(), prefilter::Run(2));
  std::reverse(reversed.begin(), reversed.end());
  for (std::size_t i = 0; i < one.size(); ++i) {
    EXPECT_EQ(one[i].triangle, two[i].triangle);
    EXPECT_EQ(one[i].triangle, reversed[i].triangle);
  }
}

TEST(NearestPoints, TakeSegmentsAndPointsForTriangles) {
  const std::vector<Vector3> positions = {{0, 0, 0}, {2, 0, 0}, {4, 0, 0}, {9, 9, 9}};
  const std::vector<Vector3> points = {{3, 1, 0}, {8, 9, 9}, {-1, 0, 0}};
  const std::vector<Triangle> triangles = {{0, 1, 2}, {3, 3, 3}, {2, 0, 0}};
  const auto found = nearest_points(points, {positions, triangles}, prefilter::Run(1));
  EXPECT_NEAR(found[0].distance, 1.0, 1e-12);
  EXPECT_NEAR(found[1].distance, 1.0, 1e-12);
  EXPECT_NEAR(found[2].distance, 1.0, 1e-12);
}

TEST(NearestPoints, TreesAreReusable) {
  Soup soup = random_soup(5, 300, 0.2);
  const Soup asked = random_soup(6, 50, 0.5);
  const auto wanted = nearest_points(asked.positions, soup.view(), prefilter::Run(1));
  const NearestPoints tree(soup.view(), prefilter::Run(1));
  soup = Soup();  // the tree has a copy
  for (std::size_t i = 0; i < asked.positions.size(); ++i) {
    const auto found = tree.find(std::span(asked.positions).subspan(i, 1), prefilter::Run(1));
    EXPECT_EQ(found[0].triangle, wanted[i].triangle);
    EXPECT_EQ(found[0].weights, wanted[i].weights);
  }
  EXPECT_TRUE(tree.find({}, prefilter::Run(1)).empty());
}

// The lowest index among triangles at the same distance, compared with a linear search.
TEST(NearestPoints, HaveTheLowestIndexOfSeveral) {
  Soup soup = random_soup(7, 60, 0.4);
  std::mt19937 random(8);
  const std::size_t own = soup.triangles.size();
  for (int copy = 0; copy < 150; ++copy) {
    Triangle triangle = soup.triangles[random() % own];
    std::rotate(triangle.begin(), triangle.begin() + random() % 3, triangle.end());
    if (copy % 2 == 0) std::swap(triangle[0], triangle[1]);
    soup.triangles.push_back(triangle);
  }
  std::shuffle(soup.triangles.begin(), soup.triangles.end(), random);
  // At vertices many triangles have distance 0.
  for (std::size_t v = 0; v < soup.positions.size(); v += 5) {
    const Vector3& vertex = soup.positions[v];
    std::int64_t lowest = -1;
    for (std::size_t t = soup.triangles.size(); t-- > 0;) {
      const auto one = nearest_points(std::span(&vertex, 1),
                                      {soup.positions, std::span(soup.triangles).subspan(t, 1)},
                                      prefilter::Run(1));
      if (one[0].distance == 0.0) lowest = static_cast<std::int64_t>(t);
    }
    const auto found = nearest_points(std::span(&vertex, 1), soup.view(), prefilter::Run(1));
    EXPECT_EQ(found[0].triangle, lowest);
  }
}

// Without merging, searches would test all of them, and take hundreds of times as long.
TEST(NearestPoints, CoincidentTrianglesAreFast) {
  constexpr std::size_t kCopies = 120000;
  Soup soup;
  soup.positions = {{0, 0, 0}, {1, 0, 0.5}, {0, 1, 0.25}, {3, 3, 3}};
  for (std::size_t i = 0; i < kCopies; ++i) {
    soup.triangles.push_back(i % 3 == 0 ? Triangle{1, 2, 0} : Triangle{0, 1, 2});
    soup.triangles.push_back({3, 3, 3});
  }
  const Soup asked = random_soup(9, 20000, 0.5);
  const std::clock_t began = std::clock();
  const auto found = nearest_points(asked.positions, soup.view(), prefilter::Run(1));
  EXPECT_LT(std::clock() - began, 20 * CLOCKS_PER_SEC);
  for (const SurfacePoint& point : found) EXPECT_LE(point.triangle, 1);
}

TEST(NearestPoints, AreTheSameInStacksAndFans) {
  Soup soup;
  soup.positions.push_back({0, 0, 0.3});
  std::mt19937 random(10);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  constexpr int kTriangles = 2000;
  for (int i = 0; i < kTriangles; ++i) {
    const auto first = static_cast<std::int64_t>(soup.positions.size());
    const double angle = 6.28 * i / kTriangles;
    soup.positions.push_back({std::cos(angle), std::sin(angle), 0.0});
    soup.positions.push_back({std::cos(angle + 0.01), std::sin(angle + 0.01), 0.0});
    soup.triangles.push_back({0, first, first + 1});
    const double jitter = 1e-9 * uniform(random);
    soup.positions.push_back({2.0 + jitter, 0.0, 0.0});
    soup.positions.push_back({3.0, jitter, 1.0});
    soup.positions.push_back({2.0, 1.0, 0.5 + jitter});
    soup.triangles.push_back({first + 2, first + 3, first + 4});
  }
  Soup asked = random_soup(11, 150, 0.5);
  for (Vector3& p : asked.positions) p[2] += 1.0;
  const auto wanted = nearest_points(asked.positions, soup.view(), prefilter::Run(1));
  std::reverse(asked.positions.begin(), asked.positions.end());
  auto found = nearest_points(asked.positions, soup.view(), prefilter::Run(2));
  std::reverse(found.begin(), found.end());
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    EXPECT_EQ(found[i].triangle, wanted[i].triangle);
    EXPECT_EQ(found[i].weights, wanted[i].weights);
  }
}

}  // namespace
}  // namespace prefilter
