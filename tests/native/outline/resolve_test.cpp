#include "prefilter/outline/resolve.h"

#include <gtest/gtest.h>

#include "outline/outline_oracle.h"

namespace prefilter {
namespace {

using namespace outline_oracle;

// Compares what is filled before with the winding numbers after, away from the curves.
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

constexpr FillRule kRules[] = {FillRule::kNonzero, FillRule::kEvenOdd};

TEST(Resolve, FillsWhatTheRuleFills) {
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

TEST(Resolve, NothingStaysNothing) {
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

}  // namespace
}  // namespace prefilter
