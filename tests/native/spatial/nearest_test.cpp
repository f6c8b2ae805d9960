#include "prefilter/spatial/nearest.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "prefilter/base/error.h"

namespace prefilter {
namespace {

using Vector = std::array<double, 3>;
using Triangle = std::array<std::int64_t, 3>;

struct Soup {
  std::vector<Vector> positions;
  std::vector<Triangle> triangles;
};

Soup random_soup(unsigned seed, int count, double size) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  Soup soup;
  for (int t = 0; t < count; ++t) {
    const Vector centre = {uniform(random), uniform(random), uniform(random)};
    for (int i = 0; i < 3; ++i) {
      soup.positions.push_back({centre[0] + size * uniform(random),
                                centre[1] + size * uniform(random),
                                centre[2] + size * uniform(random)});
    }
    soup.triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
  }
  return soup;
}

double distance(const Vector& a, const Vector& b) {
  return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}

Vector point_at(const Soup& soup, const SurfacePoint& at) {
  Vector p{};
  for (int i = 0; i < 3; ++i) {
    const auto vertex =
        soup.triangles[static_cast<std::size_t>(at.triangle)][static_cast<std::size_t>(i)];
    for (int a = 0; a < 3; ++a)
      p[a] += at.weights[i] * soup.positions[static_cast<std::size_t>(vertex)][a];
  }
  return p;
}

// The distance to a triangle by projected gradient over its two free weights, from a fine start:
// slow, and another method.
double slow_distance(const Vector& p, const Vector& a, const Vector& b, const Vector& c) {
  double best = 1e300;
  double best_v = 0.0;
  double best_w = 0.0;
  double step = 0.25;
  const auto at = [&](double v, double w) {
    Vector q;
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
        nearest_points(asked.positions, soup.positions, soup.triangles, Progress(), 1);
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
  const auto one = nearest_points(asked.positions, soup.positions, soup.triangles, Progress(), 1);
  const auto two = nearest_points(asked.positions, soup.positions, soup.triangles, Progress(), 2);
  std::reverse(asked.positions.begin(), asked.positions.end());
  auto reversed = nearest_points(asked.positions, soup.positions, soup.triangles, Progress(), 2);
  std::reverse(reversed.begin(), reversed.end());
  for (std::size_t i = 0; i < one.size(); ++i) {
    EXPECT_EQ(one[i].triangle, two[i].triangle);
    EXPECT_EQ(one[i].triangle, reversed[i].triangle);
  }
}

TEST(NearestPoints, TakeSegmentsAndPointsForTriangles) {
  const std::vector<Vector> positions = {{0, 0, 0}, {2, 0, 0}, {4, 0, 0}, {9, 9, 9}};
  const std::vector<Vector> points = {{3, 1, 0}, {8, 9, 9}, {-1, 0, 0}};
  const std::vector<Triangle> triangles = {{0, 1, 2}, {3, 3, 3}, {2, 0, 0}};
  const auto found = nearest_points(points, positions, triangles, Progress(), 1);
  EXPECT_NEAR(found[0].distance, 1.0, 1e-12);
  EXPECT_NEAR(found[1].distance, 1.0, 1e-12);
  EXPECT_NEAR(found[2].distance, 1.0, 1e-12);
}

TEST(NearestPoints, NameWhatIsWrong) {
  const std::vector<Vector> positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  const std::vector<Triangle> triangles = {{0, 1, 2}};
  const std::vector<Vector> points = {{0, 0, 1}};
  EXPECT_THROW(nearest_points(points, positions, {}, Progress(), 1), Error);
  const std::vector<Triangle> bad = {{0, 1, 3}};
  EXPECT_THROW(nearest_points(points, positions, bad, Progress(), 1), Error);
  const std::vector<Vector> nan = {{0, NAN, 1}};
  EXPECT_THROW(nearest_points(nan, positions, triangles, Progress(), 1), Error);
}

}  // namespace
}  // namespace prefilter
