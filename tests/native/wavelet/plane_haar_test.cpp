// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/wavelet/plane_haar.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "prefilter/base/outline.h"

namespace prefilter {
namespace {

PlaneHaar analyze(const Outline& outline, const PlaneGrid& grid, int strip_rows) {
  std::vector<StripBricks> strips;
  OutlineStrip strip;
  for (int row = 0; row < grid.height; row += strip_rows) {
    strip.begin(grid, row, std::min(row + strip_rows, grid.height));
    for (const Outline::Segment& segment : outline.segments()) {
      for_monotone_pieces(outline.controls(segment), segment.weight,
                          [&](const MonotoneCurve& piece, bool backward) {
                            strip.add(piece, backward ? -1.0 : 1.0);
                          });
    }
    strips.push_back(strip.take());
  }
  return PlaneHaar(grid, strips);
}

// Row by row, at the positions of the finest cells.
std::vector<float> values_of(const PlaneHaar& tree, const PlaneGrid& grid, int cell_depth) {
  std::vector<float> values(static_cast<std::size_t>(grid.width) * grid.height, NAN);
  const auto at = [&](int x, int y) -> float& {
    return values[static_cast<std::size_t>(y) * grid.width + x];
  };
  tree.synthesise(
      cell_depth, 0, grid.height,
      [&](int row, int begin, int end, float value) {
        for (int x = begin; x < end; ++x) at(x, row) = value;
      },
      [&](int x, int y, const auto& block) {
        for (int i = 0; i < 64; ++i) {
          if (x + i % 8 < grid.width && y + i / 8 < grid.height)
            at(x + i % 8, y + i / 8) = block[i];
        }
      });
  return values;
}

std::vector<Point2> clipped(const std::vector<Point2>& polygon, int axis, double limit, int sign) {
  std::vector<Point2> kept;
  const auto height = [&](const Point2& p) { return sign * ((axis == 0 ? p.x : p.y) - limit); };
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Point2& a = polygon[i];
    const Point2& b = polygon[(i + 1) % polygon.size()];
    if (height(a) >= 0.0) kept.push_back(a);
    if ((height(a) > 0.0 && height(b) < 0.0) || (height(a) < 0.0 && height(b) > 0.0)) {
      kept.push_back(a + (height(a) / (height(a) - height(b))) * (b - a));
    }
  }
  return kept;
}

// The mean winding number over a square, by clipping the whole polygon to it.
double clipped_mean(std::vector<Point2> polygon, double x, double y, double side) {
  for (int axis = 0; axis < 2; ++axis) {
    const double low = axis == 0 ? x : y;
    polygon = clipped(polygon, axis, low, 1);
    polygon = clipped(polygon, axis, low + side, -1);
  }
  double area = 0.0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    area += 0.5 * cross(polygon[i], polygon[(i + 1) % polygon.size()]);
  }
  return area / (side * side);
}

Outline outline_of(const std::vector<Point2>& polygon) {
  Outline outline;
  outline.move_to(polygon[0]);
  for (std::size_t i = 1; i < polygon.size(); ++i) outline.line_to(polygon[i]);
  outline.close();
  return outline;
}

class Random {
 public:
  explicit Random(int seed) : engine_(seed) {}
  Point2 point(double low, double high) {
    std::uniform_real_distribution<double> uniform(low, high);
    const double x = uniform(engine_);
    return {x, uniform(engine_)};
  }
  std::vector<Point2> points(int count, double low, double high) {
    std::vector<Point2> all;
    for (int i = 0; i < count; ++i) all.push_back(point(low, high));
    return all;
  }

 private:
  std::mt19937 engine_;
};

// Curves of all kinds, in a closed contour.
Outline curves(Random* random, double low, double high) {
  Outline outline;
  outline.move_to(random->point(low, high));
  for (const int degree : {1, 2, 3, 4, 9}) outline.curve_to(random->points(degree, low, high));
  outline.conic_to(random->point(low, high), 0.7, random->point(low, high));
  outline.conic_to(random->point(low, high), 4.0, random->point(low, high));
  outline.close();
  return outline;
}

TEST(PlaneHaar, EveryDepthIsTheMeanOfPolygons) {
  Random random(1);
  for (const double reach : {0.3, 1.0, 3.0, 1e5}) {
    const auto polygon = random.points(9, 16.0 - 16.0 * reach, 16.0 + 16.0 * reach);
    const PlaneGrid grid(32, 32);
    const PlaneHaar tree = analyze(outline_of(polygon), grid, 8);
    for (int cell_depth = 0; cell_depth <= 5; ++cell_depth) {
      const auto values = values_of(tree, grid, cell_depth);
      const int side = 1 << cell_depth;
      for (int y = 0; y < 32; ++y) {
        for (int x = 0; x < 32; ++x) {
          EXPECT_NEAR(values[32 * y + x],
                      clipped_mean(polygon, x / side * side, y / side * side, side),
                      reach > 10.0 ? 2e-6 : 6e-7);
        }
      }
    }
  }
}

TEST(PlaneHaar, GridsNeedNotBeSquares) {
  Random random(2);
  for (const auto& [width, height] : {std::pair(1, 1), {3, 9}, {40, 7}, {9, 40}, {33, 31}}) {
    const auto polygon = random.points(7, -10.0, 50.0);
    const PlaneGrid grid(width, height);
    const auto values = values_of(analyze(outline_of(polygon), grid, 16), grid, 0);
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        EXPECT_NEAR(values[y * width + x], clipped_mean(polygon, x, y, 1.0), 6e-7);
      }
    }
  }
}

TEST(PlaneHaar, CurvesAreTheirFineLines) {
  Random random(3);
  for (int round = 0; round < 5; ++round) {
    const Outline outline = curves(&random, -4.0, 36.0);
    std::vector<Point2> polygon;
    for (const Outline::Segment& segment : outline.segments()) {
      const ParametricCurve curve(outline.controls(segment), segment.weight);
      for (int i = 0; i < 40000; ++i) polygon.push_back(curve.at(i / 40000.0));
    }
    const PlaneGrid grid(32, 32);
    const auto curved = values_of(analyze(outline, grid, 32), grid, 0);
    const auto straight = values_of(analyze(outline_of(polygon), grid, 32), grid, 0);
    for (std::size_t i = 0; i < curved.size(); ++i) EXPECT_NEAR(curved[i], straight[i], 1e-6);
  }
}

TEST(PlaneHaar, HalvesOfCurvesAreTheCurves) {
  Random random(4);
  const auto p = random.points(4, 0.0, 32.0);
  const Point2 a = 0.5 * (p[0] + p[1]);
  const Point2 b = 0.5 * (p[1] + p[2]);
  const Point2 c = 0.5 * (p[2] + p[3]);
  const Point2 ab = 0.5 * (a + b);
  const Point2 bc = 0.5 * (b + c);
  Outline whole;
  whole.move_to(p[0]);
  whole.curve_to(std::span(p).subspan(1));
  whole.close();
  Outline halves;
  halves.move_to(p[0]);
  halves.curve_to(std::array{a, ab, 0.5 * (ab + bc)});
  halves.curve_to(std::array{bc, c, p[3]});
  halves.line_to(0.5 * (p[3] + p[0]));
  halves.close();
  const PlaneGrid grid(32, 32);
  const auto one = values_of(analyze(whole, grid, 32), grid, 0);
  const auto two = values_of(analyze(halves, grid, 32), grid, 0);
  for (std::size_t i = 0; i < one.size(); ++i) EXPECT_NEAR(one[i], two[i], 3e-7);
}

// Along grid lines, and through corners of cells.
TEST(PlaneHaar, WholeCellsAreWhole) {
  const PlaneGrid grid(64, 40);
  const std::vector<Point2> square = {{8, 8}, {24, 8}, {24, 24}, {8, 24}};
  auto values = values_of(analyze(outline_of(square), grid, 16), grid, 0);
  for (int y = 0; y < 40; ++y) {
    for (int x = 0; x < 64; ++x) {
      const bool is_in = x >= 8 && x < 24 && y >= 8 && y < 24;
      EXPECT_EQ(values[64 * y + x], is_in ? 1.0F : 0.0F);
    }
  }
  const std::vector<Point2> diamond = {{16, 0}, {32, 16}, {16, 32}, {0, 16}};
  values = values_of(analyze(outline_of(diamond), grid, 16), grid, 0);
  for (int y = 0; y < 40; ++y) {
    for (int x = 0; x < 64; ++x) {
      EXPECT_EQ(values[64 * y + x], static_cast<float>(clipped_mean(diamond, x, y, 1.0)));
    }
  }
  for (const Point2 far : {Point2{-1e9, -1e9}, Point2{-1.0, -1.0}}) {
    const std::vector<Point2> around = {far, {1e9, far.y}, {1e9, 1e9}, {far.x, 1e9}};
    for (const float value : values_of(analyze(outline_of(around), grid, 16), grid, 0)) {
      EXPECT_EQ(value, 1.0F);
    }
  }
}

TEST(PlaneHaar, DegenerateContoursContributeNothing) {
  const PlaneGrid grid(30, 30);
  for (const std::vector<Point2>& flat : {std::vector<Point2>{{3, 4}},
                                          {{3, 4}, {3, 4}, {3, 4}},
                                          {{3.5, 4.5}, {20.1, 11.3}},
                                          {{0, 0}, {30, 0}, {10, 0}},
                                          {{-5, -9}, {-5, 90}},
                                          {{-9, -9}, {90, 90}}}) {
    for (const float value : values_of(analyze(outline_of(flat), grid, 8), grid, 0)) {
      EXPECT_EQ(value, 0.0F);
    }
  }
  for (const float value : values_of(analyze({}, grid, 8), grid, 0)) EXPECT_EQ(value, 0.0F);
}

TEST(PlaneHaar, StripsDoNotMatter) {
  Random random(5);
  const Outline outline = curves(&random, -10.0, 110.0);
  const PlaneGrid grid(100, 90);
  const auto whole = values_of(analyze(outline, grid, 96), grid, 0);
  for (const int rows : {8, 24}) {
    const auto values = values_of(analyze(outline, grid, rows), grid, 0);
    for (std::size_t i = 0; i < whole.size(); ++i) EXPECT_NEAR(values[i], whole[i], 2e-7);
  }
}

// The error of a cell of side s that contains a point and a gap of length L is 3/4 (|n_x| + |n_y|)
// L / s. The sides of such cells start at r / sqrt(2), and double.
TEST(PlaneHaar, GapErrorsFallWithDistance) {
  const int side = 128;
  const PlaneGrid grid(side, side);
  std::vector<Point2> circle;
  constexpr int kCorners = 200;
  for (int i = 0; i < kCorners; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / kCorners;
    circle.push_back({61.0 + 50.0 * std::cos(angle), 66.0 + 50.0 * std::sin(angle)});
  }
  const auto closed = values_of(analyze(outline_of(circle), grid, side), grid, 0);
  for (int missing = 0; missing < kCorners; missing += 7) {
    Outline open;
    open.move_to(circle[(missing + 1) % kCorners]);
    for (int i = 2; i <= kCorners; ++i) open.line_to(circle[(missing + i) % kCorners]);
    const Point2& a = circle[missing];
    const Point2& b = circle[(missing + 1) % kCorners];
    const double length = std::hypot(b.x - a.x, b.y - a.y);
    const auto values = values_of(analyze(open, grid, side), grid, 0);
    double most = 0.0;
    for (int y = 0; y < side; ++y) {
      for (int x = 0; x < side; ++x) {
        // From the nearest corner of the cell to the nearest point of the gap.
        const double r = std::hypot(x + 0.5 - 0.5 * (a.x + b.x), y + 0.5 - 0.5 * (a.y + b.y)) -
                         0.5 * length - std::sqrt(0.5);
        const double off = std::abs(values[side * y + x] - closed[side * y + x]);
        most = std::max(most, off);
        if (r > 1.0) {
          EXPECT_LE(off, 3.0 * length / r + length / side);
        }
      }
    }
    EXPECT_GT(most, 0.05);
  }
}

}  // namespace
}  // namespace prefilter
