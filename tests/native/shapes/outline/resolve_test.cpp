// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/shapes/resolve.h"

#include <gtest/gtest.h>

#include <numbers>

#include "shapes/outline/outline_oracle.h"

namespace prefilter {
namespace {

using namespace outline_oracle;

// Compares the filled region before with the winding numbers after, at points away from the curves.
void expect_resolved(const Outline& outline, FillRule rule, double clearance = 2e-3,
                     int count = 400) {
  const Outline result = resolve(outline, rule);
  const std::vector<Chain> before = fine_chains(outline);
  const std::vector<Chain> after = fine_chains(result);
  for (const Point2& point : random_points(outline, count, clearance, 1)) {
    ASSERT_EQ(winding(after, point), filled(winding(before, point), rule) ? 1 : 0)
        << point.x << ", " << point.y;
  }
}

Outline joined(const std::vector<Outline>& outlines) {
  Outline all;
  for (const Outline& outline : outlines) all.append(outline);
  return all;
}

Outline random_curves(unsigned seed, int contours, int segments) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> place(0.0, 100.0);
  std::uniform_int_distribution<int> degree(1, 5);
  Outline outline;
  for (int c = 0; c < contours; ++c) {
    outline.move_to({place(random), place(random)});
    for (int s = 0; s < segments; ++s) {
      const int chosen = degree(random);
      if (chosen == 5) {
        const Point2 control = {place(random), place(random)};
        outline.conic_to(control, 0.2 + place(random) / 50.0, {place(random), place(random)});
        continue;
      }
      std::vector<Point2> points;
      for (int i = 0; i < chosen; ++i) points.push_back({place(random), place(random)});
      outline.curve_to(points);
    }
    outline.close();
  }
  return outline;
}

// A counter-clockwise closed curve with waves.
Outline wavy_ring(double radius, int count) {
  std::vector<Point2> points;
  for (int i = 0; i < count; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / count;
    const double r = radius * (1.0 + 0.1 * std::sin(5.0 * angle) + (i % 2 == 0 ? 1e-3 : 0.0));
    points.push_back({r * std::cos(angle), r * std::sin(angle)});
  }
  return polygon(points);
}

constexpr FillRule kRules[] = {FillRule::kNonzero, FillRule::kEvenOdd};

TEST(Resolve, KeepsTheFilledRegion) {
  for (const FillRule rule : kRules) {
    for (unsigned seed = 0; seed < 12; ++seed) {
      SCOPED_TRACE(seed);
      expect_resolved(random_curves(seed, 1 + seed % 3, 3 + seed % 4), rule);
    }
    const Outline inner = circle({0, 0}, 1.0);
    const Outline outer = circle({0, 0}, 2.0);
    expect_resolved(joined({outer, inner}), rule);
    expect_resolved(joined({outer, reversed(inner)}), rule);
    expect_resolved(joined({reversed(outer), reversed(inner)}), rule);
    expect_resolved(joined({outer, circle({1.5, 0.5}, 1.0), circle({0.1, 3.0}, 2.0)}), rule);
  }
}

TEST(Resolve, EmptyStaysEmpty) {
  Outline outline;
  EXPECT_TRUE(resolve(outline, FillRule::kNonzero).empty());
  outline.move_to({1, 2});
  EXPECT_TRUE(resolve(outline, FillRule::kNonzero).empty());
  outline.line_to({3, 4});
  EXPECT_TRUE(resolve(outline, FillRule::kNonzero).empty());
  outline.close();
  EXPECT_TRUE(resolve(outline, FillRule::kEvenOdd).empty());
  outline.move_to({5, 5});
  outline.line_to({5, 5});
  outline.line_to({5, 5});
  outline.close();
  EXPECT_TRUE(resolve(outline, FillRule::kEvenOdd).empty());
}

bool same_points(const Outline& a, const Outline& b) {
  return std::equal(a.points().begin(), a.points().end(), b.points().begin(), b.points().end());
}

TEST(Resolve, LeavesResolvedOutlinesUnchanged) {
  const Outline ring = joined({circle({5, 5}, 3.0), reversed(circle({5, 5}, 2.0))});
  const Outline wavy = wavy_ring(1, 40);
  Outline quads;
  for (int x = 0; x < 8; ++x) {
    for (int y = 0; y < 8; ++y) {
      const double left = 0.1 * x;
      const double low = 0.3 * y;
      const double right = 0.1 * (x + 1);
      const double high = 0.3 * (y + 1);
      quads.append(polygon({{left, low}, {right, low}, {right, high}, {left, high}}));
    }
  }
  for (const FillRule rule : kRules) {
    EXPECT_FALSE(resolved(ring, rule));
    EXPECT_FALSE(resolved(wavy, rule));
    EXPECT_FALSE(resolved(quads, rule));
    EXPECT_TRUE(same_points(resolve(ring, rule), ring));
    EXPECT_TRUE(same_points(resolve(reversed(wavy), rule), reversed(reversed(wavy))));
  }
}

TEST(Resolve, MeshesStayTrianglesAndUniteWhereOneOverlaps) {
  constexpr int kSide = 20;
  std::mt19937 random(2);
  std::uniform_real_distribution<double> off(-0.3, 0.3);
  std::vector<Point2> corners;
  for (int y = 0; y <= kSide; ++y) {
    for (int x = 0; x <= kSide; ++x) corners.push_back({x + off(random), y + off(random)});
  }
  const auto at = [&](int x, int y) {
    return corners[static_cast<std::size_t>(y * (kSide + 1) + x)];
  };
  Outline mesh;
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      mesh.append(polygon({at(x, y), at(x + 1, y), at(x + 1, y + 1)}));
      mesh.append(polygon({at(x, y), at(x + 1, y + 1), at(x, y + 1)}));
    }
  }
  EXPECT_FALSE(resolved(mesh, FillRule::kNonzero));
  const double whole = area(fine_chains(mesh, 1));
  mesh.append(polygon({{5.1, 5.2}, {7.3, 5.4}, {6.0, 8.1}}));
  const Outline united = resolve(mesh, FillRule::kNonzero);
  EXPECT_NEAR(area(fine_chains(united, 1)), whole, 1e-9);
  EXPECT_EQ(united.contour_count(), 1u);
  EXPECT_EQ(united.segments().size(), 4u * kSide);
}

TEST(Resolve, RuleDecidesWhichContoursAreKept) {
  // The second contour makes a shape that is not convex.
  for (const auto& make : {+[](double radius) {
                             return circle({0, 0}, radius);
                           },
                           +[](double radius) { return wavy_ring(radius, 12); }}) {
    const Outline large = make(3.0);
    const Outline middle = make(2.0);
    const Outline small = make(1.0);
    EXPECT_TRUE(same_points(resolve(joined({large, middle, small}), FillRule::kNonzero), large));
    EXPECT_TRUE(same_points(resolve(joined({large, middle, small}), FillRule::kEvenOdd),
                            joined({large, reversed(middle), small})));
    EXPECT_TRUE(same_points(resolve(joined({large, reversed(middle), small}), FillRule::kNonzero),
                            joined({large, reversed(middle), small})));
    EXPECT_TRUE(
        same_points(resolve(reversed(large), FillRule::kNonzero), reversed(reversed(large))));
    EXPECT_TRUE(same_points(resolve(joined({reversed(large), reversed(small)}), FillRule::kNonzero),
                            reversed(reversed(large))));
  }
}

TEST(Resolve, CrossingCurvesStayCurves) {
  const Outline two = joined({circle({0, 0}, 1.0), circle({1, 0}, 1.0)});
  const double lens = 2.0 * std::numbers::pi / 3.0 - std::sqrt(3.0) / 2.0;
  const auto areas = {std::pair(FillRule::kNonzero, 2.0 * std::numbers::pi - lens),
                      std::pair(FillRule::kEvenOdd, 2.0 * std::numbers::pi - 2.0 * lens)};
  for (const auto& [rule, expected] : areas) {
    const Outline result = resolve(two, rule);
    EXPECT_NEAR(area(result), expected, 1e-8);
    EXPECT_LE(result.segments().size(), 12u);
    for (const Outline::Segment& segment : result.segments()) EXPECT_GT(segment.weight, 0.0);
    const double half = std::sqrt(0.75);
    const auto& points = result.points();
    EXPECT_TRUE(std::any_of(points.begin(), points.end(), [&](const Point2& p) {
      return std::fabs(p.x - 0.5) < 1e-15 && std::fabs(p.y - half) < 1e-15;
    }));
  }
}

TEST(Resolve, ConvexContoursAtAnyPosition) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  for (int round = 0; round < 40; ++round) {
    SCOPED_TRACE(round);
    Outline outline;
    for (int i = 0; i < 6; ++i) {
      const AffineMap2 map = {{1.0 + 4.0 * unit(random), unit(random)},
                              {unit(random), 1.0 + 4.0 * unit(random)},
                              {20.0 * unit(random), 20.0 * unit(random)}};
      const Outline one = circle({0, 0}, 1.0).transformed(map);
      outline.append(unit(random) < 0.5 ? one : reversed(one));
      if (round % 2 == 0) outline.append(one.transformed({{0.4, 0}, {0, 0.4}, 0.6 * map.origin}));
    }
    expect_resolved(outline, kRules[round % 2], 1e-2, 100);
  }
}

TEST(Resolve, NastyOutlines) {
  const Outline disc = circle({0, 0}, 10.0);
  const std::vector<Outline> outlines = {
      joined({disc, disc}),
      joined({disc, reversed(disc)}),
      joined({disc, disc, disc, reversed(disc)}),
      joined({disc, circle({5, 0}, 5.0), circle({-5, 0}, 5.0)}),          // touch inside
      joined({disc, reversed(circle({0, 15}, 5.0))}),                     // touch outside
      polygon({{0, 0}, {10, 0}, {10, 10}, {10, 15}, {10, 10}, {0, 10}}),  // a spike
      polygon({{0, 0},
               {10, 0},
               {10, 10},
               {5, 10},
               {5, 7},
               {3, 5},
               {5, 3},
               {7, 5},
               {5, 7},
               {5, 10},
               {0, 10}}),  // a slit to a hole
      polygon({{0, 0}, {10, 10}, {10, 0}, {0, 10}}),
      polygon({{0, 0}, {10, 0}, {5, 5}, {10, 10}, {0, 10}, {5, 5}}),  // touches itself
      joined(
          {polygon({{0, 0}, {6, 0}, {6, 6}, {0, 6}}), polygon({{3, 0}, {9, 0}, {9, 6}, {3, 6}})}),
      polygon({{0, 0}, {0.3, 0.1}, {0.6, 0.2}, {0.9, 0.3}}),  // no area
  };
  for (const Outline& outline : outlines) {
    for (const FillRule rule : kRules) {
      for (const AffineMap2& map :
           {AffineMap2{}, AffineMap2{{0.8, 0.6}, {-0.6, 0.8}, {1.0 / 3.0, 0.1}},
            AffineMap2{{1e9, 0}, {0, 1e9}, {}}, AffineMap2{{1e-9, 0}, {0, 1e-9}, {}},
            AffineMap2{{1, 0}, {0, 1}, {1e6, -1e6}}}) {
        const double size = std::hypot(map.x_axis.x, map.x_axis.y);
        expect_resolved(outline.transformed(map), rule, 2e-3 * std::max(size, 1e-9), 60);
      }
    }
  }
}

TEST(Resolve, TangentCurves) {
  for (const double angle : {0.0, 0.3, 2.0}) {
    const Point2 way = {std::cos(angle), std::sin(angle)};
    const Outline disc = circle({0, 0}, 10.0);
    for (const double radius : {1.0, 4.0, 9.0}) {
      for (const FillRule rule : kRules) {
        expect_resolved(joined({disc, circle((10.0 - radius) * way, radius)}), rule, 2e-3, 60);
        expect_resolved(joined({disc, reversed(circle((10.0 + radius) * way, radius))}), rule, 2e-3,
                        60);
      }
    }
  }
  // The curves cross where they touch, to third order.
  Outline cubic;
  cubic.move_to({-1, -1});
  cubic.curve_to(std::vector<Point2>{{-1.0 / 3.0, 1}, {1.0 / 3.0, -1}, {1, 1}});
  cubic.line_to({1, -3});
  cubic.line_to({-1, -3});
  cubic.close();
  expect_resolved(joined({cubic, polygon({{-2, 0}, {2, 0}, {2, 2}, {-2, 2}})}), FillRule::kNonzero);
}

TEST(Resolve, ManyEdges) {
  const Outline ring = wavy_ring(100.0, 50000);
  EXPECT_FALSE(resolved(ring, FillRule::kNonzero));
  const Outline two = joined({ring, ring.transformed({{1, 0}, {0, 1}, {50.0, 0.0}})});
  const double whole = area(fine_chains(resolve(two, FillRule::kNonzero), 1));
  const double parts = area(fine_chains(resolve(two, FillRule::kEvenOdd), 1));
  EXPECT_NEAR(2.0 * whole - parts, area(fine_chains(two, 1)), 1e-6);
}

}  // namespace
}  // namespace prefilter
