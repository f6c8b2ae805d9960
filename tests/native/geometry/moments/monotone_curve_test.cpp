// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/geometry/moments/monotone_curve.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "geometry/moments/random_curves.h"

namespace prefilter {
namespace {

struct Piece {
  MonotoneCurve curve;
  bool backward = false;
};

std::vector<Piece> pieces_of(std::span<const Point2> controls, double weight) {
  std::vector<Piece> pieces;
  for_monotone_pieces(controls, weight, [&](const MonotoneCurve& piece, bool backward) {
    pieces.push_back({piece, backward});
  });
  return pieces;
}

// Curves of degree 4 and above only refer to their control points, so pieces are checked
// immediately.
template <typename Check>
void for_random_curves(int trials, const Check& check) {
  std::mt19937 random(1);
  for (int trial = 0; trial < trials; ++trial) {
    const RandomCurve curve = any_curve(&random, trial, 8.0);
    for_monotone_pieces(curve.controls, curve.weight,
                        [&](const MonotoneCurve& piece, bool) { check(trial, curve, piece); });
  }
}

TEST(MonotonePieces, JoinAndBeginAndEndWhereTheCurveDoes) {
  std::mt19937 random(2);
  for (int trial = 0; trial < 450; ++trial) {
    const RandomCurve curve = any_curve(&random, trial, 8.0);
    const std::vector<Piece> pieces = pieces_of(curve.controls, curve.weight);
    ASSERT_FALSE(pieces.empty());
    const bool backward = pieces.front().backward;
    const Point2 begin = backward ? curve.controls.back() : curve.controls.front();
    const Point2 end = backward ? curve.controls.front() : curve.controls.back();
    EXPECT_EQ(pieces.front().curve.begin, begin) << trial;
    EXPECT_EQ(pieces.back().curve.end, end) << trial;
    for (std::size_t i = 0; i < pieces.size(); ++i) {
      EXPECT_LE(pieces[i].curve.t_begin, pieces[i].curve.t_end) << trial;
      EXPECT_EQ(pieces[i].backward, backward);
      if (i > 0) {
        EXPECT_EQ(pieces[i].curve.begin, pieces[i - 1].curve.end) << trial;
      }
    }
  }
}

TEST(MonotonePieces, NeitherTurnNorLeaveTheCurve) {
  for_random_curves(180, [](int trial, const RandomCurve& random, const MonotoneCurve& piece) {
    constexpr int kSteps = 40;
    constexpr double kNearly = 1e-9;
    const bool x_rises = piece.end.x >= piece.begin.x;
    const bool y_rises = piece.end.y >= piece.begin.y;
    Point2 last = piece.begin;
    for (int k = 0; k <= kSteps; ++k) {
      const double t = piece.t_begin + (piece.t_end - piece.t_begin) * k / kSteps;
      const Point2 at = k == kSteps ? piece.end : piece.curve.at(t);
      ASSERT_GE(x_rises ? at.x - last.x : last.x - at.x, -kNearly) << trial;
      ASSERT_GE(y_rises ? at.y - last.y : last.y - at.y, -kNearly) << trial;
      last = at;
      if (random.weight == 0.0) continue;
      // A conic in barycentric coordinates of its control points: b1^2 = 4 w^2 b0 b2.
      const auto& p = random.controls;
      const double area = cross(p[1] - p[0], p[2] - p[0]);
      const double b0 = cross(p[1] - at, p[2] - at) / area;
      const double b2 = cross(p[0] - at, p[1] - at) / area;
      const double b1 = 1.0 - b0 - b2;
      const double bound = 1e-9 * (1.0 + random.weight * random.weight) / std::abs(area);
      ASSERT_NEAR(b1 * b1, 4.0 * random.weight * random.weight * b0 * b2, bound) << trial;
    }
  });
}

TEST(MonotonePieces, AreTheSameFromTheOtherEnd) {
  std::mt19937 random(3);
  for (int trial = 0; trial < 450; ++trial) {
    RandomCurve curve = any_curve(&random, trial, 8.0);
    const std::vector<Piece> pieces = pieces_of(curve.controls, curve.weight);
    std::reverse(curve.controls.begin(), curve.controls.end());
    const std::vector<Piece> turned = pieces_of(curve.controls, curve.weight);
    ASSERT_EQ(pieces.size(), turned.size());
    for (std::size_t i = 0; i < pieces.size(); ++i) {
      EXPECT_NE(pieces[i].backward, turned[i].backward);
      EXPECT_EQ(pieces[i].curve.begin, turned[i].curve.begin);
      EXPECT_EQ(pieces[i].curve.end, turned[i].curve.end);
      EXPECT_EQ(pieces[i].curve.t_end, turned[i].curve.t_end);
    }
  }
}

TEST(MonotonePieces, LinesAreSinglePieces) {
  const std::vector<Point2> controls = {{1.0, 2.0}, {3.0, 7.0}};
  const std::vector<Piece> pieces = pieces_of(controls, 0.0);
  ASSERT_EQ(pieces.size(), 1U);
  EXPECT_FALSE(pieces[0].backward);
  EXPECT_EQ(pieces[0].curve.curve.kind, CurveKind::kLine);
}

TEST(MonotonePieces, PointsAreSinglePieces) {
  for (const std::size_t count : {2U, 3U, 4U, 6U, 61U}) {
    const std::vector<Point2> controls(count, Point2{3.0, 4.0});
    for (const double weight : {0.0, 0.5, 1e6}) {
      if (weight > 0.0 && count != 3) continue;
      for (const Piece& piece : pieces_of(controls, weight)) {
        for (const Point2& end : {piece.curve.begin, piece.curve.end}) {
          EXPECT_NEAR(end.x, 3.0, 1e-14);
          EXPECT_NEAR(end.y, 4.0, 1e-14);
        }
      }
    }
  }
}

std::vector<double> turns_of(const std::vector<Point2>& controls, double weight) {
  const ParametricCurve curve(controls, weight);
  std::array<double, kMostTurns> turns;
  const int count = turning_points(curve, controls, &turns);
  return {turns.begin(), turns.begin() + count};
}

TEST(TurningPoints, OfKnownCurves) {
  // y = 4 t (1 - t), as a quadratic, and with its degree raised.
  const std::vector<std::vector<Point2>> arches = {
      {{0, 0}, {1, 2}, {2, 0}},
      {{0, 0}, {2.0 / 3, 4.0 / 3}, {4.0 / 3, 4.0 / 3}, {2, 0}},
      {{0, 0}, {0.5, 1}, {1, 4.0 / 3}, {1.5, 1}, {2, 0}},
  };
  for (const auto& arch : arches) {
    const std::vector<double> turns = turns_of(arch, 0.0);
    ASSERT_EQ(turns.size(), 1U) << arch.size();
    EXPECT_NEAR(turns[0], 0.5, 1e-12);
  }
  EXPECT_TRUE(turns_of({{0, 0}, {1, 1}, {2, 3}, {5, 4}}, 0.0).empty());
  const std::vector<double> conic = turns_of({{1, 0}, {1, 5}, {-1, 0}}, 0.6);
  ASSERT_EQ(conic.size(), 1U);
  EXPECT_NEAR(conic[0], 0.5, 1e-12);
}

TEST(Crossing, IsWhereTheCurveIs) {
  for_random_curves(180, [](int trial, const RandomCurve&, const MonotoneCurve& piece) {
    for (int axis = 0; axis < 2; ++axis) {
      const double begin = axis == 0 ? piece.begin.x : piece.begin.y;
      const double end = axis == 0 ? piece.end.x : piece.end.y;
      if (std::abs(end - begin) < 1e-6) continue;
      for (const double share : {1e-9, 0.1, 0.5, 0.77, 1.0 - 1e-9}) {
        const double value = begin + share * (end - begin);
        const double t = crossing(piece, axis, value, piece.t_begin);
        ASSERT_GE(t, piece.t_begin);
        ASSERT_LE(t, piece.t_end);
        const Point2 at = piece.curve.at(t);
        ASSERT_NEAR(axis == 0 ? at.x : at.y, value, 1e-12) << trial;
      }
    }
  });
}

TEST(ParametricCurve, MatchesBernsteinPolynomials) {
  std::mt19937 random(5);
  for (int trial = 0; trial < 180; ++trial) {
    const RandomCurve random_one = any_curve(&random, trial, 1.0);
    const ParametricCurve curve(random_one.controls, random_one.weight);
    for (const double t : {0.0, 0.2, 0.5, 0.9, 1.0}) {
      const Point2 expected = bernstein(random_one.controls, random_one.weight, t);
      EXPECT_NEAR(curve.at(t).x, expected.x, 1e-12) << trial;
      EXPECT_NEAR(curve.at(t).y, expected.y, 1e-12) << trial;
    }
    for (const double t : {0.3, 0.7}) {
      constexpr double kStep = 1e-5;
      const Point2 ahead = bernstein(random_one.controls, random_one.weight, t + kStep);
      const Point2 behind = bernstein(random_one.controls, random_one.weight, t - kStep);
      const Point2 slope = (0.5 / kStep) * (ahead - behind);
      EXPECT_NEAR(curve.derivative(t).x, slope.x, 1e-5 * (1.0 + std::abs(slope.x))) << trial;
      EXPECT_NEAR(curve.derivative(t).y, slope.y, 1e-5 * (1.0 + std::abs(slope.y))) << trial;
    }
  }
}

TEST(ParametricCurve, PairsMatchSingleParameters) {
  for_random_curves(60, [](int, const RandomCurve&, const MonotoneCurve& piece) {
    const ParametricCurve& curve = piece.curve;
    if (curve.kind == CurveKind::kBezier) return;
    const DoublePair t{piece.t_begin + 0.3 * (piece.t_end - piece.t_begin), piece.t_end};
    const ParametricCurve::Pair pair = curve.pair_at(t);
    for (int k = 0; k < 2; ++k) {
      EXPECT_EQ(pair.x[k], curve.at(t[k]).x);
      EXPECT_EQ(pair.y[k], curve.at(t[k]).y);
      EXPECT_EQ(pair.y_slope[k], curve.derivative(t[k]).y);
    }
  });
}

}  // namespace
}  // namespace prefilter
