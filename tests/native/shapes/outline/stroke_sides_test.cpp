// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/shapes/outline/stroke_sides.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "shapes/outline/outline_oracle.h"

namespace prefilter {
namespace {

using namespace outline_oracle;

constexpr double kTolerance = 1e-3;

StrokePath path_of(const Outline& outline, bool is_closed = false) {
  StrokePath path;
  path.is_closed = is_closed;
  for (const Outline::Segment& segment : outline.contour(0)) {
    path.curves.emplace_back(curve_of(outline, segment), 0.0, 1.0);
  }
  return path;
}

StrokePath lines(const std::vector<Point2>& points) {
  Outline outline;
  outline.move_to(points.front());
  for (std::size_t i = 1; i < points.size(); ++i) outline.line_to(points[i]);
  return path_of(outline);
}

void expect_points(const Outline& side, const std::vector<Point2>& expected) {
  ASSERT_EQ(side.points().size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_NEAR(side.points()[i].x, expected[i].x, 1e-12) << i;
    EXPECT_NEAR(side.points()[i].y, expected[i].y, 1e-12) << i;
  }
}

Outline side_of(const StrokePath& path, double offset, StrokeJoin join, double miter_limit = 4.0) {
  const auto pieces = stroke_pieces(path, std::fabs(offset), kTolerance);
  return stroke_side(pieces, path.is_closed, offset, join, miter_limit, kTolerance);
}

double off(const Point2& a, const Point2& b) { return std::hypot(a.x - b.x, a.y - b.y); }

TEST(StrokePieces, SidesAreAHalfWidthBesideTheCurve) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> place(0.0, 100.0);
  int curves = 0;
  for (int trial = 0; trial < 24; ++trial) {
    Outline way;
    way.move_to({place(random), place(random)});
    std::vector<Point2> points;
    for (int d = 0; d < 2 + trial % 3; ++d) points.push_back({place(random), place(random)});
    way.curve_to(points);
    const double half_width = trial % 2 == 0 ? 0.5 : 12.0;
    const std::vector<Chain> fine = fine_chains(way, 4000);
    const auto pieces = stroke_pieces(path_of(way), half_width, kTolerance);
    ASSERT_FALSE(pieces.empty());
    EXPECT_EQ(pieces.front().begin, way.points().front());
    EXPECT_EQ(pieces.back().end, way.points().back());
    for (std::size_t i = 0; i < pieces.size(); ++i) {
      const StrokePiece& piece = pieces[i];
      if (i > 0) {
        EXPECT_EQ(piece.begin, pieces[i - 1].end);
        EXPECT_EQ(piece.is_smooth, !piece.is_cusp);
      }
      EXPECT_NEAR(std::hypot(piece.begin_normal.x, piece.begin_normal.y), 1.0, 1e-12);
      if (piece.kind != StrokePiece::Kind::kCurve) {
        // A flat piece deviates from the curve by less than the tolerance.
        EXPECT_LE(distance(fine, 0.5 * (piece.begin + piece.end)), kTolerance);
        continue;
      }
      ++curves;
      Outline side;
      side.move_to(piece.begin + half_width * piece.begin_normal);
      side.curve_to(std::vector<Point2>{piece.left_controls[0], piece.left_controls[1],
                                        piece.end + half_width * piece.end_normal});
      side.move_to(piece.begin - half_width * piece.begin_normal);
      side.curve_to(std::vector<Point2>{piece.right_controls[0], piece.right_controls[1],
                                        piece.end - half_width * piece.end_normal});
      for (const Outline::Segment& segment : side.segments()) {
        for (const double t : {0.1, 0.3, 0.5, 0.7, 0.9}) {
          // Another part of the curve may be nearer, but the point is not beside any part that is
          // farther than this.
          EXPECT_LE(distance(fine, bernstein(side, segment, t)), half_width + kTolerance);
        }
      }
    }
  }
  EXPECT_GT(curves, 60);
}

std::ptrdiff_t cusps(const StrokePath& path) {
  const auto pieces = stroke_pieces(path, 2.0, kTolerance);
  return std::count_if(pieces.begin(), pieces.end(), [](const auto& p) { return p.is_cusp; });
}

TEST(StrokePieces, ACuspIsNotSmooth) {
  Outline way;
  way.move_to({0, 0});
  way.curve_to(std::vector<Point2>{{10, 10}, {0, 10}, {10, 0}});
  StrokePath path;  // the cusp is at no dyadic fraction of the path
  path.curves.emplace_back(curve_of(way, way.segments()[0]), 0.0, 0.77);
  EXPECT_GE(cusps(path), 1);
  Outline smooth;
  smooth.move_to({0, 0});
  smooth.curve_to(std::vector<Point2>{{10, 10}, {20, 0}});
  EXPECT_EQ(cusps(path_of(smooth)), 0);
}

TEST(StrokeSides, CornersAreJoinedOnTheOutside) {
  const StrokePath corner = lines({{0, 0}, {10, 0}, {10, 10}});  // to the left
  expect_points(side_of(corner, -1.0, StrokeJoin::kMiter),
                {{0, -1}, {10, -1}, {11, -1}, {11, 0}, {11, 10}});
  expect_points(side_of(corner, -1.0, StrokeJoin::kBevel), {{0, -1}, {10, -1}, {11, 0}, {11, 10}});
  // The miter of a right angle is sqrt(2) times as long as the stroke is wide.
  expect_points(side_of(corner, -1.0, StrokeJoin::kMiter, 1.41),
                {{0, -1}, {10, -1}, {11, 0}, {11, 10}});
  const Outline round = side_of(corner, -1.0, StrokeJoin::kRound);
  ASSERT_EQ(round.segments().size(), 3U);
  for (const double t : {0.0, 0.2, 0.5, 0.8, 1.0}) {
    EXPECT_NEAR(off(bernstein(round, round.segments()[1], t), {10, 0}), 1.0, 1e-12);
  }
}

TEST(StrokeSides, RoundJoinsGoAroundTheOutside) {
  for (const double degrees : {20.0, 89.0, 120.0, 179.0, -60.0, -170.0}) {
    const double angle = degrees / 180.0 * std::numbers::pi;
    const Point2 end = {10.0 + 10.0 * std::cos(angle), 10.0 * std::sin(angle)};
    const double offset = degrees > 0.0 ? -2.0 : 2.0;
    const Outline side = side_of(lines({{0, 0}, {10, 0}, end}), offset, StrokeJoin::kRound);
    const auto segments = side.segments();
    ASSERT_EQ(segments.size(), std::fabs(degrees) > 90.0 ? 4U : 3U) << degrees;
    for (std::size_t i = 1; i + 1 < segments.size(); ++i) {
      for (const double t : {0.0, 0.3, 0.6, 1.0}) {
        const Point2 at = bernstein(side, segments[i], t);
        EXPECT_NEAR(off(at, {10, 0}), 2.0, 1e-9) << degrees;
        EXPECT_GE(distance({{{0, 0}, {10, 0}, end}}, at), 2.0 - 1e-9) << degrees;
      }
    }
  }
}

TEST(StrokeSides, InnerOffsetsMeetIfLinesAreLongEnough) {
  // The offset lines of a right angle intersect one offset before the corner.
  expect_points(side_of(lines({{0, 0}, {10, 0}, {10, 10}}), 1.0, StrokeJoin::kMiter),
                {{0, 1}, {9, 1}, {9, 10}});
  expect_points(side_of(lines({{0, 0}, {10, 0}, {10, 0.9}}), 1.0, StrokeJoin::kMiter),
                {{0, 1}, {10, 1}, {10, 0}, {9, 0}, {9, 0.9}});
  Outline square = polygon({{0, 0}, {10, 0}, {10, 10}, {0, 10}});
  const StrokePath closed = path_of(square, true);
  expect_points(side_of(closed, 1.0, StrokeJoin::kMiter), {{1, 1}, {9, 1}, {9, 9}, {1, 9}, {1, 1}});
  expect_points(side_of(closed, -1.0, StrokeJoin::kMiter), {{0, -1},
                                                            {10, -1},
                                                            {11, -1},
                                                            {11, 0},
                                                            {11, 10},
                                                            {11, 11},
                                                            {10, 11},
                                                            {0, 11},
                                                            {-1, 11},
                                                            {-1, 10},
                                                            {-1, 0},
                                                            {-1, -1},
                                                            {0, -1}});
}

// The side of a tight turn runs backward. It may wind more than once, but never negatively, so that
// the non-zero rule fills it.
TEST(StrokeSides, FoldsDoNotWindBackward) {
  Outline way;
  way.move_to({0, 0});
  way.curve_to(std::vector<Point2>{{10, 0.1}, {0, 0.2}});
  const StrokePath path = path_of(way);
  const auto pieces = stroke_pieces(path, 2.0, kTolerance);
  Outline covered = stroke_side(pieces, false, -2.0, StrokeJoin::kRound, 4.0, kTolerance);
  append_cap(pieces.back().end, pieces.back().end_normal, 2.0, StrokeCap::kRound, &covered);
  const Outline left = stroke_side(pieces, false, 2.0, StrokeJoin::kRound, 4.0, kTolerance);
  for (std::size_t i = left.segments().size(); i-- > 0;) {
    const Curve curve = curve_of(left, left.segments()[i]);
    append_curve(curve, true, curve.begin(), &covered);
  }
  append_cap(pieces.front().begin, -1.0 * pieces.front().begin_normal, 2.0, StrokeCap::kRound,
             &covered);
  covered.close();
  const std::vector<Chain> chains = fine_chains(covered, 100);
  const std::vector<Chain> fine = {fine_chains(way, 1000)[0]};
  for (const Point2& point : random_points(covered, 500, 1e-6, 5)) {
    const double beside = distance({Chain(fine[0].begin(), fine[0].end() - 1)}, point) - 2.0;
    if (std::fabs(beside) < 5e-3) continue;
    const int count = winding(chains, point);
    EXPECT_GE(count, 0);
    EXPECT_EQ(count > 0, beside < 0.0) << point.x << ", " << point.y;
  }
}

TEST(StrokeSides, CapsReachAHalfWidthBeyondTheEnd) {
  for (const StrokeCap cap : {StrokeCap::kButt, StrokeCap::kSquare, StrokeCap::kRound}) {
    Outline outline;
    outline.move_to({0, -3});
    append_cap({0, 0}, {0, 1}, 3.0, cap, &outline);  // the path runs along x
    EXPECT_EQ(outline.points().back(), (Point2{0, 3}));
    outline.close();
    const double expected = cap == StrokeCap::kButt     ? 0.0
                            : cap == StrokeCap::kSquare ? 18.0
                                                        : 4.5 * std::numbers::pi;
    EXPECT_NEAR(area(outline), expected, 1e-6);
  }
}

}  // namespace
}  // namespace prefilter
