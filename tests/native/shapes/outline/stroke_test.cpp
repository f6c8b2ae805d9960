// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/shapes/stroke.h"

#include <gtest/gtest.h>

#include <numbers>

#include "prefilter/base/error.h"
#include "shapes/outline/outline_oracle.h"

namespace prefilter {
namespace {

using namespace outline_oracle;

constexpr double kPi = std::numbers::pi;

std::vector<Chain> open_chains(const Outline& outline) {
  std::vector<Chain> chains = fine_chains(outline, 1000);
  for (Chain& chain : chains) chain.pop_back();  // the closing line is not drawn
  return chains;
}

StrokeOptions round_stroke(double width) {
  StrokeOptions options;
  options.width = width;
  options.join = StrokeJoin::kRound;
  options.cap = StrokeCap::kRound;
  return options;
}

// A stroke with round joins and caps covers exactly the points within half its width.
void expect_near_is_covered(const Outline& outline, double width, unsigned seed) {
  const Outline covered = stroke(outline, round_stroke(width));
  const std::vector<Chain> after = fine_chains(covered, 100);
  const std::vector<Chain> way = open_chains(outline);
  Outline around = outline;
  around.append(covered);
  int inside = 0;
  for (const Point2& point : random_points(around, 200, 0.0, seed)) {
    const double off = distance(way, point) - 0.5 * width;
    if (std::fabs(off) < 2e-3) continue;
    ASSERT_EQ(winding(after, point), off < 0.0 ? 1 : 0) << point.x << ", " << point.y;
    inside += off < 0.0 ? 1 : 0;
  }
  EXPECT_GT(inside, 3);
}

Outline curve(std::vector<Point2> points) {
  Outline outline;
  outline.move_to(points.front());
  outline.curve_to(std::span(points).subspan(1));
  return outline;
}

TEST(Stroke, CoversPointsWithinHalfTheWidth) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> place(0.0, 100.0);
  for (unsigned seed = 0; seed < 12; ++seed) {
    SCOPED_TRACE(seed);
    Outline outline;
    outline.move_to({place(random), place(random)});
    for (int i = 0; i < 3; ++i) {
      std::vector<Point2> points;
      for (unsigned d = 0; d < 1 + (seed + i) % 4; ++d) {
        points.push_back({place(random), place(random)});
      }
      outline.curve_to(points);
    }
    if (seed % 3 == 0) outline.close();
    expect_near_is_covered(outline, seed % 2 == 0 ? 3.0 : 25.0, seed);
  }
}

TEST(Stroke, CuspsAndLoopsAreCovered) {
  expect_near_is_covered(curve({{0, 0}, {10, 10}, {0, 10}, {10, 0}}), 4.0, 1);  // a cusp
  expect_near_is_covered(curve({{0, 0}, {30, 20}, {-20, 20}, {10, 0}}), 2.0, 2);
  expect_near_is_covered(curve({{0, 0}, {10, 0}, {0, 0}}), 2.0, 3);  // there and back
  expect_near_is_covered(curve({{0, 0}, {0, 0}, {5, 5}, {5, 5}}), 3.0, 4);
  expect_near_is_covered(curve({{0, 0}, {10, 0.1}, {0, 0.2}}), 4.0, 5);
  Outline conic;
  conic.move_to({0, 0});
  conic.conic_to({10, 10}, 3.0, {20, 0});
  conic.conic_to({20, -30}, 0.3, {0, -5});
  expect_near_is_covered(conic, 5.0, 6);
}

TEST(Stroke, CircleBecomesRing) {
  for (const Outline& way : {circle({3, 4}, 50.0), reversed(circle({3, 4}, 50.0))}) {
    StrokeOptions options;
    options.width = 10.0;
    const Outline ring = stroke(way, options);
    EXPECT_EQ(ring.contour_count(), 2u);
    EXPECT_NEAR(area(ring), kPi * (55.0 * 55.0 - 45.0 * 45.0), 0.2);
    EXPECT_LE(ring.segments().size(), 128u);
  }
}

TEST(Stroke, CornersAreJoined) {
  Outline corner;
  corner.move_to({0, 0});
  corner.line_to({10, 0});
  corner.line_to({10, 10});
  StrokeOptions options;
  options.width = 2.0;
  EXPECT_NEAR(area(stroke(corner, options)), 40.0, 1e-12);
  options.join = StrokeJoin::kBevel;
  EXPECT_NEAR(area(stroke(corner, options)), 39.5, 1e-12);
  options.join = StrokeJoin::kRound;
  EXPECT_NEAR(area(stroke(corner, options)), 39.0 + kPi / 4.0, 1e-4);

  options.join = StrokeJoin::kMiter;
  options.miter_limit = std::sqrt(2.0) * 0.999;
  EXPECT_NEAR(area(stroke(corner, options)), 39.5, 1e-12);
  options.miter_limit = std::sqrt(2.0) * 1.001;
  EXPECT_NEAR(area(stroke(corner, options)), 40.0, 1e-12);

  corner.line_to({0, 10});
  corner.close();
  const Outline frame = stroke(corner, options);
  EXPECT_EQ(frame.contour_count(), 2u);
  EXPECT_NEAR(area(frame), 144.0 - 64.0, 1e-12);
}

TEST(Stroke, EndsHaveCaps) {
  Outline line;
  line.move_to({0, 0});
  line.line_to({6, 8});
  StrokeOptions options;
  options.width = 2.0;
  EXPECT_NEAR(area(stroke(line, options)), 20.0, 1e-12);
  options.cap = StrokeCap::kSquare;
  EXPECT_NEAR(area(stroke(line, options)), 24.0, 1e-12);
  options.cap = StrokeCap::kRound;
  EXPECT_NEAR(area(stroke(line, options)), 20.0 + kPi, 1e-4);
}

TEST(Stroke, ContoursOfNoLengthAreCaps) {
  Outline point;
  point.move_to({5, 5});
  StrokeOptions options;
  options.width = 2.0;
  options.cap = StrokeCap::kSquare;
  EXPECT_TRUE(stroke(point, options).empty());
  point.line_to({5, 5});
  EXPECT_NEAR(area(stroke(point, options)), 4.0, 1e-12);
  options.cap = StrokeCap::kRound;
  EXPECT_NEAR(area(stroke(point, options)), kPi, 1e-4);
  options.cap = StrokeCap::kButt;
  EXPECT_TRUE(stroke(point, options).empty());
  options.width = 0.0;
  EXPECT_TRUE(stroke(circle({0, 0}, 1.0), options).empty());
  Outline closed;
  closed.move_to({5, 5});
  closed.close();
  options = round_stroke(2.0);
  EXPECT_NEAR(area(stroke(closed, options)), kPi, 1e-4);
}

TEST(Stroke, DashesHaveTheirArcLength) {
  StrokeOptions options;
  options.width = 2.0;
  options.dashes = {10.0};
  Outline line;
  line.move_to({0, 0});
  line.line_to({45, 0});
  Outline dashed = stroke(line, options);
  EXPECT_EQ(dashed.contour_count(), 3u);
  EXPECT_NEAR(area(dashed), 2.0 * 25.0, 1e-9);
  options.dash_offset = 15.0;  // starts with 5 units of a gap
  dashed = stroke(line, options);
  EXPECT_EQ(dashed.contour_count(), 2u);
  EXPECT_NEAR(area(dashed), 2.0 * 20.0, 1e-9);
  options.dash_offset = -5.0;
  EXPECT_NEAR(area(stroke(line, options)), 2.0 * 20.0, 1e-9);

  // A tenth of a circle each; the first lies half before the start and half after it.
  const double part = 2.0 * kPi * 50.0 / 20.0;
  options.dashes = {part, part};
  options.dash_offset = 0.5 * part;
  dashed = stroke(circle({0, 0}, 50.0), options);
  EXPECT_EQ(dashed.contour_count(), 10u);
  EXPECT_NEAR(area(dashed), 10.0 * part * 2.0, 0.01);

  options.dashes = {0.0, 15.0};
  options.dash_offset = 0.0;
  options.cap = StrokeCap::kRound;
  dashed = stroke(line, options);
  EXPECT_EQ(dashed.contour_count(), 3u);
  EXPECT_NEAR(area(dashed), 3.0 * kPi, 1e-3);

  options.dashes = {0.0, 0.0};
  EXPECT_EQ(stroke(line, options).contour_count(), 1u);
}

TEST(Stroke, DistantCurvesAreCutIntoFewPieces) {
  // Pieces as fine as the tolerance would be finer than the coordinates.
  for (const double far : {1e13, 1e17, 1e31}) {
    Outline outline;
    outline.move_to({0.0, 0.0});
    outline.curve_to({{{0.3 * far, 0.0}, {far, 0.2 * far}, {far, far}}});
    EXPECT_LT(stroke(outline, {}).points().size(), 20000U) << far;
  }
}

TEST(Stroke, CurvesFoldedByRoundingAreOnePiece) {
  // At this distance from the origin, the halves of an arc differ only by rounding.
  constexpr double kFar = 9.1e21;
  Outline outline;
  outline.move_to({0.0, 0.0});
  outline.line_to({30.0, kFar});
  outline.conic_to({140.0, kFar}, std::sqrt(0.5), {140.0, kFar + 0x1p20});
  outline.conic_to({-57870.0, kFar + 0x1p20}, std::sqrt(0.5), {-57860.0, kFar});
  bool winds_once = false;
  EXPECT_LT(stroke_within_budget(outline, {}, 1e-3, &winds_once).points().size(), 100U);
}

TEST(Stroke, LargeOutlinesAreScaledDown) {
  // Products of their coordinates overflow; scaling by powers of 2 changes nothing else.
  const auto wave = [](double size) {
    Outline outline;
    outline.move_to({2.0 * size, 0.0});
    outline.line_to({9.0 * size, 6.0 * size});
    outline.curve_to({{{17.0 * size, 12.0 * size}, {1.0 * size, 2.0 * size}, {size, 99.0 * size}}});
    return outline;
  };
  StrokeOptions options;
  options.width = 2.0;
  options.dashes = {30.0, 5.0};
  const Outline small = stroke(wave(1.0), options, 1e-3);
  for (const int exponent : {310, 600, 1000}) {
    const double size = std::ldexp(1.0, exponent);
    StrokeOptions large = options;
    large.width *= size;
    for (double& dash : large.dashes) dash *= size;
    const Outline found = stroke(wave(size), large, 1e-3 * size);
    ASSERT_EQ(found.points().size(), small.points().size()) << exponent;
    for (std::size_t i = 0; i < small.points().size(); ++i) {
      EXPECT_EQ(found.points()[i].x, size * small.points()[i].x);
      EXPECT_EQ(found.points()[i].y, size * small.points()[i].y);
    }
  }
}

TEST(Stroke, RefusesBadOptions) {
  const Outline line = curve({{0, 0}, {1000, 0}});
  const auto message = [&](const StrokeOptions& options) {
    try {
      stroke(line, options);
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  StrokeOptions options;
  options.width = -1.0;
  EXPECT_EQ(message(options), "width: -1; must be finite, and 0 or more");
  options.width = 1.0;
  options.dashes = {1.0, NAN};
  EXPECT_EQ(message(options), "dashes: nan; must be finite, and 0 or more");
  options.dashes = {1e-6};
  EXPECT_EQ(message(options), "dashes: more than 1000000 on one contour");
  options.dashes = {};
  options.miter_limit = 0.5;
  EXPECT_EQ(message(options), "miter_limit: 0.5; must be 1 or more");
  options.miter_limit = 4.0;
  options.dash_offset = INFINITY;
  EXPECT_EQ(message(options), "dash_offset: inf; must be finite");
}

}  // namespace
}  // namespace prefilter
