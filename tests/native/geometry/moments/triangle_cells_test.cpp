// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/geometry/moments/triangle_cells.h"

#include <gtest/gtest.h>

#include <map>
#include <random>
#include <utility>

namespace prefilter {
namespace {

// Sums moments per cell, treating full cells as pieces.
class Collector final : public CellSink {
 public:
  void add_full(int y, int x0, int x1, double density) override {
    for (int x = x0; x < x1; ++x) {
      for (int i = 0; i < 9; ++i) cells[{x, y}][i] += density * kUniformMoments[i];
    }
    full_cells += x1 - x0;
  }
  void add_piece(int x, int y, const CellPiece& piece) override {
    WeightMoments moments{};
    piece.add_moments(x, y, &moments);
    EXPECT_NEAR(moments[0], piece.mass(), 1e-12 * (1.0 + piece.mass()));
    EXPECT_GT(piece.mass(), 0.0);
    for (int i = 0; i < 9; ++i) cells[{x, y}][i] += moments[i];
  }
  double total() const {
    double sum = 0.0;
    for (const auto& [cell, moments] : cells) sum += moments[0];
    return sum;
  }

  std::map<std::pair<int, int>, WeightMoments> cells;
  int full_cells = 0;
};

// Brute force: masses at the centers of many small triangles.
std::map<std::pair<int, int>, WeightMoments> sample(const MassTriangle& triangle, int steps) {
  std::map<std::pair<int, int>, WeightMoments> cells;
  const auto& p = triangle.corners;
  const double mass = triangle.mass / (static_cast<double>(steps) * steps);
  for (int i = 0; i < steps; ++i) {
    for (int j = 0; i + j < steps; ++j) {
      for (int half = 0; half < (i + j < steps - 1 ? 2 : 1); ++half) {
        const double s = (i + (1.0 + half) / 3.0) / steps;
        const double t = (j + (1.0 + half) / 3.0) / steps;
        const double x = p[0].x + s * (p[1].x - p[0].x) + t * (p[2].x - p[0].x);
        const double y = p[0].y + s * (p[1].y - p[0].y) + t * (p[2].y - p[0].y);
        const int cx = static_cast<int>(std::floor(x));
        const int cy = static_cast<int>(std::floor(y));
        WeightMoments& moments = cells[{cx, cy}];
        for (int b = 0; b < 3; ++b) {
          for (int a = 0; a < 3; ++a) {
            moments[3 * b + a] += mass * std::pow(x - cx, a) * std::pow(y - cy, b);
          }
        }
      }
    }
  }
  return cells;
}

MassTriangle random_triangle(std::mt19937* random, double size) {
  std::uniform_real_distribution<double> place(0.0, size);
  MassTriangle triangle;
  for (GridPoint& corner : triangle.corners) corner = {place(*random), place(*random)};
  triangle.mass = 1.0;
  return triangle;
}

TEST(CutToCells, KeepsTheMassOfRandomTriangles) {
  std::mt19937 random(1);
  for (int trial = 0; trial < 2000; ++trial) {
    const MassTriangle triangle = random_triangle(&random, trial % 2 == 0 ? 16.0 : 3.0);
    Collector sink;
    cut_to_cells(triangle, {0, 0, 16, 16}, &sink);
    ASSERT_NEAR(sink.total(), 1.0, 1e-9) << "trial " << trial;
  }
}

TEST(CutToCells, MatchesSampling) {
  std::mt19937 random(2);
  for (int trial = 0; trial < 10; ++trial) {
    const MassTriangle triangle = random_triangle(&random, 5.0);
    Collector sink;
    cut_to_cells(triangle, {0, 0, 5, 5}, &sink);
    auto sampled = sample(triangle, 400);
    for (const auto& [cell, moments] : sink.cells) {
      for (int i = 0; i < 9; ++i) EXPECT_NEAR(moments[i], sampled[cell][i], 2e-3);
    }
    for (const auto& [cell, moments] : sampled) {
      if (moments[0] > 1e-3) {
        EXPECT_TRUE(sink.cells.contains(cell));
      }
    }
  }
}

TEST(CutToCells, WindowsShareATriangleWithoutOverlap) {
  std::mt19937 random(3);
  for (int trial = 0; trial < 200; ++trial) {
    const MassTriangle triangle = random_triangle(&random, 8.0);
    Collector whole;
    cut_to_cells(triangle, {0, 0, 8, 8}, &whole);
    Collector parts;
    for (int y = 0; y < 8; y += 2) {
      for (int x = 0; x < 8; x += 4) cut_to_cells(triangle, {x, y, x + 4, y + 2}, &parts);
    }
    for (const auto& [cell, moments] : whole.cells) {
      for (int i = 0; i < 9; ++i) ASSERT_NEAR(parts.cells[cell][i], moments[i], 1e-12);
    }
    EXPECT_NEAR(parts.total(), 1.0, 1e-9);
  }
}

TEST(CutToCells, FindsWholeCells) {
  Collector sink;
  cut_to_cells({{{{0, 0}, {8, 0}, {0, 8}}}, 32.0}, {0, 0, 8, 8}, &sink);
  EXPECT_EQ(sink.full_cells, 28);
  EXPECT_EQ(sink.cells.size(), 36U);
  EXPECT_NEAR(sink.total(), 32.0, 1e-12);
  // Half of cell (7, 0): the triangle (0, 0), (1, 0), (0, 1), whose x y integral is 1/24.
  EXPECT_NEAR((sink.cells[{7, 0}][0]), 0.5, 1e-14);
  EXPECT_NEAR((sink.cells[{7, 0}][4]), 1.0 / 24.0, 1e-14);
}

TEST(CutToCells, GridLinesAreSharedOnce) {
  // Squares whose sides are grid lines, as two triangles.
  Collector sink;
  cut_to_cells({{{{1, 1}, {3, 1}, {3, 3}}}, 2.0}, {0, 0, 4, 4}, &sink);
  cut_to_cells({{{{1, 1}, {3, 3}, {1, 3}}}, 2.0}, {0, 0, 4, 4}, &sink);
  ASSERT_EQ(sink.cells.size(), 4U);
  for (const auto& [cell, moments] : sink.cells) {
    for (int i = 0; i < 9; ++i) EXPECT_NEAR(moments[i], kUniformMoments[i], 1e-14);
  }
}

TEST(CutToCells, SpreadsFlatTrianglesAlongTheirSegment) {
  // The density has a kink at two thirds; the first half of the segment contains 3/8.
  Collector sink;
  cut_to_cells({{{{0, 0.5}, {4, 0.5}, {8.0 / 3.0, 0.5}}}, 1.0}, {0, 0, 4, 4}, &sink);
  EXPECT_EQ(sink.cells.size(), 4U);
  EXPECT_NEAR(sink.total(), 1.0, 1e-12);
  EXPECT_NEAR((sink.cells[{0, 0}][0] + sink.cells[{1, 0}][0]), 3.0 / 8.0, 1e-12);
}

TEST(CutToCells, GivesFlatTrianglesOnGridLinesToOneCell) {
  const MassTriangle cases[] = {
      {{{{2, 0.5}, {2, 3.5}, {2, 1.5}}}, 1.0},  // vertical
      {{{{0.5, 2}, {3.5, 2}, {1.5, 2}}}, 1.0},  // horizontal
      {{{{2, 2}, {2, 2}, {2, 2}}}, 1.0},        // a point at a corner of four cells
      {{{{0, 0}, {3, 3}, {1, 1}}}, 1.0},        // through corners
  };
  for (const MassTriangle& triangle : cases) {
    Collector sink;
    for (int y = 0; y < 4; y += 2) {
      for (int x = 0; x < 4; x += 2) cut_to_cells(triangle, {x, y, x + 2, y + 2}, &sink);
    }
    EXPECT_NEAR(sink.total(), 1.0, 1e-12);
  }
}

TEST(CutToCells, KeepsTheMassOfSlivers) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> place(0.0, 8.0);
  for (int trial = 0; trial < 2000; ++trial) {
    MassTriangle triangle = random_triangle(&random, 8.0);
    const double f = place(random) / 8.0;
    const double width = std::pow(10.0, -2.0 - trial % 16);
    const auto& p = triangle.corners;
    triangle.corners[2] = {p[0].x + f * (p[1].x - p[0].x) + width, p[0].y + f * (p[1].y - p[0].y)};
    Collector sink;
    cut_to_cells(triangle, {0, 0, 9, 9}, &sink);
    ASSERT_NEAR(sink.total(), 1.0, 1e-5) << "width " << width;
  }
}

TEST(CutToCells, IgnoresTrianglesWithoutMassOrOutside) {
  Collector sink;
  cut_to_cells({{{{0, 0}, {2, 0}, {0, 2}}}, 0.0}, {0, 0, 4, 4}, &sink);
  cut_to_cells({{{{5, 5}, {6, 5}, {5, 6}}}, 1.0}, {0, 0, 4, 4}, &sink);
  cut_to_cells({{{{4, 0}, {4, 3}, {4, 2}}}, 1.0}, {0, 0, 4, 4}, &sink);
  EXPECT_TRUE(sink.cells.empty());
}

TEST(CellSpan, OwnsItsLowSide) {
  EXPECT_EQ(cell_span(1.0, 3.0).first, 1);
  EXPECT_EQ(cell_span(1.0, 3.0).last, 2);
  EXPECT_EQ(cell_span(2.0, 2.0).first, 2);
  EXPECT_EQ(cell_span(2.0, 2.0).last, 2);
  EXPECT_EQ(cell_span(-0.5, 0.5).first, -1);
  EXPECT_EQ(cell_span(-0.5, 0.5).last, 0);
}

}  // namespace
}  // namespace prefilter
