// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/points/normals/local_plane.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace prefilter {
namespace {

// Three directions at right angles.
std::array<Vector3, 3> random_frame(std::mt19937* random) {
  std::normal_distribution<double> normal;
  const auto direction = [&] {
    Vector3 v = {normal(*random), normal(*random), normal(*random)};
    const double size = length(v);
    for (double& x : v) x /= size;
    return v;
  };
  const Vector3 u = direction();
  Vector3 v = cross(u, direction());
  const double size = length(v);
  for (double& x : v) x /= size;
  return {u, v, cross(u, v)};
}

// Distance of the vector from the plane or line of eigenvectors of the least eigenvalues, if the
// first `alike` eigenvalues are equal.
double error(const std::array<Vector3, 3>& frame, int alike, const Vector3& vector) {
  double square = 0.0;
  for (int i = alike; i < 3; ++i)
    square += std::pow(dot(frame[static_cast<std::size_t>(i)], vector), 2);
  return std::sqrt(square);
}

TEST(LeastEigenvector, RecoversKnownEigenvectors) {
  struct Case {
    std::array<double, 3> eigenvalues;  // ascending
    int alike;
    double tolerance;
  };
  const Case cases[] = {{{0, 1, 1}, 1, 1e-14},       {{0, 1, 2}, 1, 1e-14},
                        {{0, 1e-3, 1}, 1, 1e-11},    {{0, 1e-6, 1}, 1, 1e-8},
                        {{0, 0, 1}, 2, 1e-14},       {{1, 1, 2}, 2, 1e-7},
                        {{1, 1.01, 1.02}, 1, 1e-11}, {{-1, 0, 1}, 1, 1e-14},
                        {{-3, -2, -2}, 1, 1e-14},    {{1e-6, 1, 1.5}, 1, 1e-14}};
  std::mt19937 random(1);
  for (const Case& c : cases) {
    for (const double scale : {1.0, 1e-200, 1e200}) {
      for (int round = 0; round < 200; ++round) {
        const std::array<Vector3, 3> frame = random_frame(&random);
        SymmetricMatrix matrix;
        for (std::size_t i = 0; i < 3; ++i) matrix.add_square(scale * c.eigenvalues[i], frame[i]);
        const Vector3 found = least_eigenvector(matrix);
        EXPECT_NEAR(length(found), 1.0, 1e-14);
        EXPECT_LT(error(frame, c.alike, found), c.tolerance)
            << c.eigenvalues[0] << " " << c.eigenvalues[1] << " " << c.eigenvalues[2];
      }
    }
  }
}

TEST(LeastEigenvector, HandlesEqualEigenvaluesAndZero) {
  EXPECT_NEAR(length(least_eigenvector({2.0, 0.0, 0.0, 2.0, 0.0, 2.0})), 1.0, 1e-15);
  EXPECT_EQ(least_eigenvector({}), Vector3{});
  EXPECT_EQ(least_eigenvector({1.0, 0.0, 0.0, 1.0, 0.0, 0.0}), (Vector3{0.0, 0.0, 1.0}));
}

TEST(Flatness, DistinguishesLinesFromDiscs) {
  std::mt19937 random(2);
  for (const double share : {0.0, 0.001, 0.1, 1.0}) {
    for (const double scale : {1.0, 1e-200, 1e200}) {
      const std::array<Vector3, 3> frame = random_frame(&random);
      SymmetricMatrix matrix;
      matrix.add_square(scale * share, frame[1]);
      matrix.add_square(scale, frame[2]);
      const double wanted = share / ((1.0 + share) * (1.0 + share));
      EXPECT_NEAR(flatness(matrix, frame[0]), wanted, 1e-14);
    }
  }
  EXPECT_EQ(flatness({}, {0.0, 0.0, 1.0}), 0.0);
}

}  // namespace
}  // namespace prefilter
