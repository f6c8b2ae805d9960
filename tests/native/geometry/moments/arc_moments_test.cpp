// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/geometry/moments/arc_moments.h"

#include <gtest/gtest.h>

#include <array>
#include <vector>

#include "geometry/moments/random_curves.h"

namespace prefilter {
namespace {

// Half of the error allowed for an image with the box filter.
constexpr double kCurveBound = 5e-7;
constexpr double kUnit = 1.0 / (1 << kMomentBits);

template <int N>
struct Integrals {
  std::array<std::array<double, N + 1>, N + 1> inside{};
  std::array<double, N + 1> across{};
};

// Simpson's rule over t, with many steps.
template <int N>
Integrals<N> integrals(const ParametricCurve& curve, double t_begin, double t_end, Point2 center,
                       int steps = 400) {
  Integrals<N> sums;
  const double step = (t_end - t_begin) / steps;
  for (int k = 0; k <= steps; ++k) {
    const double weight = k == 0 || k == steps ? 1.0 : k % 2 == 1 ? 4.0 : 2.0;
    const double t = t_begin + k * step;
    const Point2 at = curve.at(t) - center;
    const double dy = weight * step / 3.0 * curve.derivative(t).y;
    double y_power = 1.0;
    for (int b = 0; b <= N; ++b) {
      const double mean = b % 2 == 0 && b > 0 ? std::pow(0.5, b) / (b + 1) : 0.0;
      const double height = dy * (y_power - mean);
      sums.across[b] += height;
      double x_power = at.x;
      for (int a = 0; a <= N; ++a) {
        sums.inside[a][b] += height * x_power / (a + 1);
        x_power *= at.x;
      }
      y_power *= at.y;
    }
  }
  return sums;
}

template <int N>
void expect_near(const ArcMoments<N>& found, const Integrals<N>& expected, double sign,
                 double bound) {
  for (int b = 0; b <= N; ++b) {
    ASSERT_NEAR(found.across(b) * kUnit, sign * expected.across[b], bound) << b;
    for (int a = 0; a <= N; ++a) {
      ASSERT_NEAR(found.inside(a, b) * kUnit, sign * expected.inside[a][b], bound) << a << b;
    }
  }
}

template <typename Degree>
class ArcMomentsOf : public testing::Test {
 protected:
  static constexpr int kDegree = Degree::value;
  using Cells = std::vector<ArcMoments<kDegree>>;
};

using Degrees = testing::Types<std::integral_constant<int, 0>, std::integral_constant<int, 1>,
                               std::integral_constant<int, 3>, std::integral_constant<int, 7>>;
TYPED_TEST_SUITE(ArcMomentsOf, Degrees);

TYPED_TEST(ArcMomentsOf, LinesAreTheirIntegrals) {
  constexpr int kN = TestFixture::kDegree;
  std::mt19937 random(1);
  std::uniform_real_distribution<double> place(-0.5, 0.5);
  ArcBatch<kN> batch;
  for (int trial = 0; trial < 100; ++trial) {
    typename TestFixture::Cells cells(3);
    const Point2 begin{place(random), place(random)};
    const Point2 end{place(random), trial % 10 == 0 ? begin.y : place(random)};
    const int sign = trial % 2 == 0 ? 1 : -1;
    batch.add_line(begin, end, sign, 1, &cells);
    batch.flush(&cells);
    const std::array<Point2, 2> controls = {begin, end};
    expect_near<kN>(cells[1], integrals<kN>(ParametricCurve(controls, 0.0), 0.0, 1.0, {}), sign,
                    1e-7);
    EXPECT_TRUE(cells[0].is_zero());
    EXPECT_TRUE(cells[2].is_zero());
  }
}

TYPED_TEST(ArcMomentsOf, CurvesAreTheirIntegrals) {
  constexpr int kN = TestFixture::kDegree;
  std::mt19937 random(2);
  ArcBatch<kN> batch;
  for (int trial = 0; trial < 45; ++trial) {
    RandomCurve curve = any_curve(&random, trial, 1.0);
    if (curve.controls.size() == 2) continue;
    const Point2 center{0.5, 0.5};
    for_monotone_pieces(curve.controls, curve.weight, [&](const MonotoneCurve& piece, bool) {
      typename TestFixture::Cells cells(1);
      batch.add_curve(piece.curve, {piece.t_begin, piece.t_end, piece.begin, piece.end}, center, 1,
                      0, &cells);
      batch.flush(&cells);
      expect_near<kN>(cells[0], integrals<kN>(piece.curve, piece.t_begin, piece.t_end, center), 1.0,
                      kCurveBound);
    });
  }
}

// Their points concentrate at the ends or in the middle.
TYPED_TEST(ArcMomentsOf, SharpConicsAreTheirIntegrals) {
  constexpr int kN = TestFixture::kDegree;
  ArcBatch<kN> batch;
  const std::array<Point2, 3> controls = {{{0.05, 0.1}, {0.4, 0.9}, {0.95, 0.95}}};
  for (const double weight : {0.01, 0.05, 0.2, 5.0, 20.0, 100.0}) {
    for_monotone_pieces(controls, weight, [&](const MonotoneCurve& piece, bool) {
      typename TestFixture::Cells cells(1);
      batch.add_curve(piece.curve, {piece.t_begin, piece.t_end, piece.begin, piece.end}, {0.5, 0.5},
                      1, 0, &cells);
      batch.flush(&cells);
      expect_near<kN>(cells[0],
                      integrals<kN>(piece.curve, piece.t_begin, piece.t_end, {0.5, 0.5}, 20000),
                      1.0, kCurveBound);
    });
  }
}

TYPED_TEST(ArcMomentsOf, AnEdgeAndItsReverseCancel) {
  constexpr int kN = TestFixture::kDegree;
  std::mt19937 random(3);
  ArcBatch<kN> batch;
  typename TestFixture::Cells cells(1);
  for (int trial = 0; trial < 45; ++trial) {
    const RandomCurve curve = any_curve(&random, trial, 1.0);
    for (const int sign : {1, -1}) {
      for_monotone_pieces(curve.controls, curve.weight, [&](const MonotoneCurve& piece, bool) {
        if (piece.curve.kind == CurveKind::kLine) {
          batch.add_line(piece.begin, piece.end, sign, 0, &cells);
        } else {
          batch.add_curve(piece.curve, {piece.t_begin, piece.t_end, piece.begin, piece.end},
                          {0.5, 0.5}, sign, 0, &cells);
        }
      });
    }
  }
  batch.flush(&cells);
  EXPECT_TRUE(cells[0].is_zero());
}

TYPED_TEST(ArcMomentsOf, WhatCrossesTheWholeRowIsWhole) {
  constexpr int kN = TestFixture::kDegree;
  std::mt19937 random(4);
  std::uniform_real_distribution<double> place(-0.5, 0.5);
  ArcBatch<kN> batch;
  for (int trial = 0; trial < 100; ++trial) {
    typename TestFixture::Cells cells(1);
    const int parts = 1 + trial % 9;
    std::vector<Point2> chain = {{place(random), -0.5}};
    for (int i = 1; i < parts; ++i) chain.push_back({place(random), place(random)});
    chain.push_back({place(random), 0.5});
    for (int i = 0; i < parts; ++i) batch.add_line(chain[i], chain[i + 1], 1, 0, &cells);
    batch.flush(&cells);
    EXPECT_EQ(cells[0].across(0), 1 << kMomentBits);
    for (int b = 1; b <= kN; ++b) EXPECT_EQ(cells[0].across(b), 0) << b;
  }
}

// Sums are modulo 2^32: intermediate results may overflow.
TYPED_TEST(ArcMomentsOf, ManyWindingsComeAndGo) {
  constexpr int kN = TestFixture::kDegree;
  ArcBatch<kN> batch;
  typename TestFixture::Cells cells(1);
  const Point2 low{0.4, -0.5};
  const Point2 high{0.45, 0.5};
  for (int i = 0; i < 1000; ++i) batch.add_line(low, high, 1, 0, &cells);
  for (int i = 0; i < 999; ++i) batch.add_line(low, high, -1, 0, &cells);
  batch.flush(&cells);
  typename TestFixture::Cells once(1);
  batch.add_line(low, high, 1, 0, &once);
  batch.flush(&once);
  EXPECT_EQ(cells[0].sums, once[0].sums);
}

}  // namespace
}  // namespace prefilter
