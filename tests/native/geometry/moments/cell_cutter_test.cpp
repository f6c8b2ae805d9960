// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/geometry/moments/cell_cutter.h"

#include <gtest/gtest.h>

#include <map>
#include <utility>
#include <vector>

#include "geometry/moments/random_curves.h"

namespace prefilter {
namespace {

constexpr double kRounding = 1e-9;
constexpr GridWindow kAround{-2, 12, -2, 12};

struct Arc {
  int column = 0;
  int row = 0;
  CellArc arc;
};

struct Left {
  int row = 0;
  double begin = 0.0;
  double end = 0.0;
};

struct Cut {
  std::vector<Arc> arcs;
  std::vector<Left> left;
};

Cut cut(const MonotoneCurve& piece, const GridWindow& window) {
  Cut found;
  cut_to_cells(
      piece, window,
      [&](int column, int row, const CellArc& arc) {
        found.arcs.push_back({column, row, arc});
      },
      [&](int row, double begin, double end) {
        found.left.push_back({row, begin, end});
      });
  return found;
}

template <typename Check>
void for_random_pieces(int trials, const Check& check) {
  std::mt19937 random(7);
  for (int trial = 0; trial < trials; ++trial) {
    RandomCurve curve = any_curve(&random, trial, 9.0);
    if (trial % 5 == 0) {  // on the grid
      for (Point2& point : curve.controls) point = {std::round(point.x), std::round(point.y)};
    }
    for_monotone_pieces(curve.controls, curve.weight,
                        [&](const MonotoneCurve& piece, bool) { check(trial, piece); });
  }
}

bool is_on_grid(double value) { return value == std::round(value); }

TEST(CutCurveToCells, ArcsJoinAndCoverThePiece) {
  for_random_pieces(450, [](int trial, const MonotoneCurve& piece) {
    const Cut found = cut(piece, kAround);
    EXPECT_TRUE(found.left.empty());
    if (piece.begin.y == piece.end.y) {
      EXPECT_TRUE(found.arcs.empty());
      return;
    }
    ASSERT_FALSE(found.arcs.empty()) << trial;
    EXPECT_EQ(found.arcs.front().arc.begin, piece.begin);
    EXPECT_EQ(found.arcs.back().arc.end, piece.end);
    for (std::size_t i = 0; i < found.arcs.size(); ++i) {
      const CellArc& arc = found.arcs[i].arc;
      EXPECT_LE(arc.t_begin, arc.t_end) << trial;
      if (i == 0) continue;
      const CellArc& before = found.arcs[i - 1].arc;
      EXPECT_EQ(arc.begin, before.end) << trial;
      EXPECT_EQ(arc.t_begin, before.t_end) << trial;
      EXPECT_TRUE(is_on_grid(arc.begin.x) || is_on_grid(arc.begin.y)) << trial;
    }
  });
}

TEST(CutCurveToCells, ArcsLieInTheirCells) {
  for_random_pieces(450, [](int trial, const MonotoneCurve& piece) {
    for (const Arc& found : cut(piece, kAround).arcs) {
      for (const Point2& end : {found.arc.begin, found.arc.end}) {
        ASSERT_GE(end.x, found.column) << trial;
        ASSERT_LE(end.x, found.column + 1) << trial;
        ASSERT_GE(end.y, found.row) << trial;
        ASSERT_LE(end.y, found.row + 1) << trial;
      }
      for (const double share : {0.25, 0.5, 0.75}) {
        const double t = found.arc.t_begin + share * (found.arc.t_end - found.arc.t_begin);
        const Point2 at = piece.curve.at(t);
        ASSERT_NEAR(at.x, found.column + 0.5, 0.5 + kRounding) << trial;
        ASSERT_NEAR(at.y, found.row + 0.5, 0.5 + kRounding) << trial;
      }
    }
  });
}

// A window yields the same arcs as a larger one; arcs to its left keep their heights.
TEST(CutCurveToCells, WindowsAgreeWithLargerOnes) {
  for_random_pieces(270, [](int trial, const MonotoneCurve& piece) {
    const Cut whole = cut(piece, kAround);
    for (const GridWindow& window :
         {GridWindow{3, 6, 2, 7}, GridWindow{0, 9, 4, 5}, GridWindow{8, 11, -1, 11}}) {
      std::map<std::pair<int, int>, double> heights;
      std::map<int, double> left;
      for (const Arc& found : whole.arcs) {
        const double height = found.arc.end.y - found.arc.begin.y;
        if (found.row < window.first_row || found.row >= window.end_row) continue;
        if (found.column < window.first_column) left[found.row] += height;
        if (found.column >= window.first_column && found.column < window.end_column) {
          heights[{found.column, found.row}] += height;
        }
      }
      const Cut part = cut(piece, window);
      for (const Arc& found : part.arcs) {
        ASSERT_GE(found.column, window.first_column);
        ASSERT_LT(found.column, window.end_column);
        ASSERT_GE(found.row, window.first_row);
        ASSERT_LT(found.row, window.end_row);
        heights[{found.column, found.row}] -= found.arc.end.y - found.arc.begin.y;
      }
      for (const Left& found : part.left) {
        ASSERT_GE(found.row, window.first_row);
        ASSERT_LT(found.row, window.end_row);
        left[found.row] -= found.end - found.begin;
      }
      for (const auto& [cell, height] : heights) ASSERT_NEAR(height, 0.0, kRounding) << trial;
      for (const auto& [row, height] : left) ASSERT_NEAR(height, 0.0, kRounding) << trial;
    }
  });
}

TEST(CutLineToCells, IsTheSameAsForCurves) {
  std::mt19937 random(8);
  for (int trial = 0; trial < 2000; ++trial) {
    RandomCurve line = random_curve(&random, 1, 9.0);
    auto& [begin, end] = *reinterpret_cast<std::array<Point2, 2>*>(line.controls.data());
    if (trial % 3 == 0) begin = {std::round(begin.x), std::round(begin.y)};
    if (trial % 4 == 0) end = {std::round(end.x), std::round(end.y)};
    if (trial % 7 == 0) end.x = begin.x;
    if (begin.y > end.y) std::swap(begin, end);
    MonotoneCurve piece;
    piece.curve = ParametricCurve(line.controls, 0.0);
    piece.begin = begin;
    piece.end = end;
    for (const GridWindow& window : {kAround, GridWindow{3, 6, 2, 7}}) {
      std::map<std::pair<int, int>, Point2> sums;  // sums of heights, and of x times heights
      std::map<int, double> left;
      for (const Arc& found : cut(piece, window).arcs) {
        const Point2 mean = 0.5 * (found.arc.begin + found.arc.end);
        const double height = found.arc.end.y - found.arc.begin.y;
        Point2& sum = sums[{found.column, found.row}];
        sum = sum + Point2{height, height * mean.x};
      }
      for (const Left& found : cut(piece, window).left) left[found.row] += found.end - found.begin;
      cut_line_to_cells(
          begin, end, window,
          [&](int column, int row, Point2 from, Point2 to) {
            ASSERT_GE(std::min(from.x, to.x), column);
            ASSERT_LE(std::max(from.x, to.x), column + 1);
            ASSERT_GE(from.y, row);
            ASSERT_LE(to.y, row + 1);
            const double height = to.y - from.y;
            Point2& sum = sums[{column, row}];
            sum = sum - Point2{height, height * 0.5 * (from.x + to.x)};
          },
          [&](int row, double from, double to) { left[row] -= to - from; });
      for (const auto& [cell, sum] : sums) {
        ASSERT_NEAR(sum.x, 0.0, kRounding) << trial;
        ASSERT_NEAR(sum.y, 0.0, kRounding) << trial;
      }
      for (const auto& [row, height] : left) ASSERT_NEAR(height, 0.0, kRounding) << trial;
    }
  }
}

TEST(CutCurveToCells, FarAwayEndsTakeNoLongerThanTheWindow) {
  const std::vector<Point2> controls = {{-1e9, -1e9}, {1e9, 1e9}};
  for_monotone_pieces(controls, 0.0, [](const MonotoneCurve& piece, bool) {
    const Cut found = cut(piece, {0, 5, 0, 5});
    EXPECT_LE(found.arcs.size() + found.left.size(), 10U);
    double height = 0.0;
    for (const Arc& arc : found.arcs) height += arc.arc.end.y - arc.arc.begin.y;
    EXPECT_NEAR(height, 5.0, 1e-5);
  });
}

}  // namespace
}  // namespace prefilter
