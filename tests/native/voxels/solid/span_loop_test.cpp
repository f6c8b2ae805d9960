// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/voxels/solid/span_loop.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

namespace prefilter {
namespace {

using Loop = std::vector<Vector3>;

double area_of(const Vector3& a, const Vector3& b, const Vector3& c) {
  return length(cross(b - a, c - a)) / 2.0;
}

double area_of(const HolePatch& patch) {
  double area = 0.0;
  for (const auto& triangle : patch.triangles()) {
    area += area_of(patch.points()[triangle.corners[0]], patch.points()[triangle.corners[1]],
                    patch.points()[triangle.corners[2]]);
  }
  return area;
}

// Smallest area of all triangulations of the points between two indices, by exhaustive search.
double smallest_area(const Loop& loop, std::size_t from, std::size_t to) {
  if (to - from < 2) return 0.0;
  double best = 1e300;
  for (std::size_t tip = from + 1; tip < to; ++tip) {
    best = std::min(best, smallest_area(loop, from, tip) + smallest_area(loop, tip, to) +
                              area_of(loop[from], loop[tip], loop[to]));
  }
  return best;
}

HolePatch span(const Loop& loop) {
  return span_loop(loop, Loop(loop.size(), Vector3{}), prefilter::Run());
}

// Each edge of the loop occurs once, forward; all others occur once in each direction.
void expect_disc(const HolePatch& patch, std::size_t border) {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> sides;
  for (const auto& triangle : patch.triangles()) {
    for (std::size_t i = 0; i < 3; ++i) {
      sides.emplace_back(triangle.corners[i], triangle.corners[(i + 1) % 3]);
    }
  }
  std::sort(sides.begin(), sides.end());
  EXPECT_EQ(std::adjacent_find(sides.begin(), sides.end()), sides.end());
  std::size_t alone = 0;
  for (const auto& [from, to] : sides) {
    if (std::binary_search(sides.begin(), sides.end(), std::pair(to, from))) continue;
    ++alone;
    EXPECT_LT(from, border);
    EXPECT_EQ(to, (from + 1) % border);
  }
  EXPECT_EQ(alone, border);
}

TEST(SpanLoop, IsTheSmallestTriangulation) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform(-0.3, 0.3);
  for (std::size_t count = 3; count <= 9; ++count) {
    for (int trial = 0; trial < 20; ++trial) {
      Loop loop;
      for (std::size_t i = 0; i < count; ++i) {
        const double angle =
            2.0 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(count);
        loop.push_back({std::cos(angle) + uniform(random), std::sin(angle) + uniform(random),
                        uniform(random)});
      }
      const HolePatch patch = span(loop);
      expect_disc(patch, count);
      EXPECT_EQ(patch.triangles().size(), count - 2);
      const double best = smallest_area(loop, 0, count - 1);
      EXPECT_GE(area_of(patch), best * (1.0 - 1e-9));
      // Triangles folded onto a neighbor have a penalty in area.
      EXPECT_LE(area_of(patch), best * 1.05);
    }
  }
}

TEST(SpanLoop, CoversPlanarPolygonsOnce) {
  // A comb: most chords are outside.
  for (const std::size_t teeth : {3U, 20U, 200U}) {
    Loop loop;
    for (std::size_t i = 0; i < teeth; ++i) {
      const double x = static_cast<double>(i) / static_cast<double>(teeth);
      const double width = 0.5 / static_cast<double>(teeth);
      loop.push_back({x, 0.5, 0.0});
      loop.push_back({x + width, 0.5, 0.0});
      loop.push_back({x + width, 0.1, 0.0});
      loop.push_back({x + 2.0 * width, 0.1, 0.0});
    }
    loop.push_back({1.0, 0.0, 0.0});
    loop.push_back({0.0, 0.0, 0.0});
    double doubled = 0.0;
    for (std::size_t i = 0; i < loop.size(); ++i) {
      doubled += cross(loop[i], loop[(i + 1) % loop.size()])[2];
    }
    const HolePatch patch = span(loop);
    expect_disc(patch, loop.size());
    const double area = std::abs(doubled) / 2.0;
    EXPECT_GT(area_of(patch), area - 1e-9) << teeth;
    // Where points are left out at first, a few triangles may stay folded.
    EXPECT_LT(area_of(patch), teeth < 100 ? area + 1e-9 : 1.05 * area) << teeth;
  }
}

TEST(SpanLoop, ApproximatesAMinimalSurfaceForLongLoops) {
  // The border of a piece of a helicoid, which is a minimal surface.
  constexpr std::size_t kSide = 1000;
  Loop loop;
  const auto helicoid = [](double u, double v) {
    return Vector3{u * std::cos(v), u * std::sin(v), 0.3 * v};
  };
  for (std::size_t i = 0; i < kSide; ++i) {
    loop.push_back(helicoid(0.2 + 0.8 * static_cast<double>(i) / kSide, 0.0));
  }
  for (std::size_t i = 0; i < kSide; ++i) {
    loop.push_back(helicoid(1.0, static_cast<double>(i) / kSide));
  }
  for (std::size_t i = 0; i < kSide; ++i) {
    loop.push_back(helicoid(1.0 - 0.8 * static_cast<double>(i) / kSide, 1.0));
  }
  for (std::size_t i = 0; i < kSide; ++i) {
    loop.push_back(helicoid(0.2, 1.0 - static_cast<double>(i) / kSide));
  }
  const HolePatch patch = span(loop);
  expect_disc(patch, loop.size());
  double area = 0.0;
  for (int i = 0; i < 1000; ++i) area += 0.0008 * std::hypot(0.2 + 0.8 * (i + 0.5) / 1000.0, 0.3);
  EXPECT_GT(area_of(patch), area);
  EXPECT_LT(area_of(patch), 1.02 * area);
}

TEST(SpanLoop, AcceptsEqualAndCollinearPoints) {
  for (const std::size_t count : {4U, 50U, 500U}) {
    const HolePatch same = span(Loop(count, Vector3{0.5, 0.5, 0.5}));
    expect_disc(same, count);
    Loop line;
    for (std::size_t i = 0; i < count; ++i) {
      const auto x = static_cast<double>(std::min(i, count - i));
      line.push_back({x / static_cast<double>(count), 0.0, 0.0});
    }
    const HolePatch flat = span(line);
    expect_disc(flat, count);
    EXPECT_NEAR(area_of(flat), 0.0, 1e-12);
  }
}

}  // namespace
}  // namespace prefilter
