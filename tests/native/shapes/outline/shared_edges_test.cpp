// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/shapes/outline/shared_edges.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "prefilter/base/curve.h"

namespace prefilter {
namespace {

bool are_beside(const std::vector<Outline>& outlines) {
  std::vector<const Outline*> pointers;
  for (const Outline& outline : outlines) pointers.push_back(&outline);
  return have_disjoint_interiors(pointers);
}

// Cells of a grid with perturbed corners, and curved sides that cells share.
class Map {
 public:
  explicit Map(int side) : side_(side) {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> shake(-0.2, 0.2);
    for (int i = 0; i < (side + 1) * (side + 1); ++i) {
      corners_.push_back({i % (side + 1) + shake(random), i / (side + 1) + shake(random)});
      bends_.push_back({shake(random), shake(random)});
    }
  }

  Outline cell(int x, int y) const {
    Outline outline;
    outline.move_to(corner(x, y));
    side(x, y, 1, 0, false, &outline);
    side(x + 1, y, 0, 1, false, &outline);
    side(x, y + 1, 1, 0, true, &outline);
    side(x, y, 0, 1, true, &outline);
    return outline;
  }
  std::vector<Outline> cells() const {
    std::vector<Outline> all;
    for (int i = 0; i < side_ * side_; ++i) all.push_back(cell(i % side_, i / side_));
    return all;
  }

 private:
  const Point2& corner(int x, int y) const { return corners_[y * (side_ + 1) + x]; }
  // The side from a corner to the next in one of two directions, of three kinds.
  void side(int x, int y, int dx, int dy, bool back, Outline* outline) const {
    const Point2& from = corner(x, y);
    const Point2& to = corner(x + dx, y + dy);
    const Point2 middle = 0.5 * (from + to) + bends_[y * (side_ + 1) + x];
    const Point2& end = back ? from : to;
    switch ((x + y + dx) % 3) {
      case 0:
        outline->line_to(end);
        break;
      case 1:
        outline->conic_to(middle, 0.8, end);
        break;
      default: {
        const Point2 points[] = {middle, end};
        outline->curve_to(points);
        break;
      }
    }
  }

  int side_;
  std::vector<Point2> corners_;
  std::vector<Point2> bends_;
};

TEST(SharedEdges, CancelInATiling) {
  const Map map(12);
  std::vector<Outline> cells = map.cells();
  EXPECT_TRUE(are_beside(cells));
  // A hole in a cell, and an enclave that fills it.
  const Outline enclave = cells[40];
  cells.erase(cells.begin() + 40);
  EXPECT_TRUE(are_beside(cells));
  cells.push_back(enclave);
  EXPECT_TRUE(are_beside(cells));
  // A second cell over the enclave.
  cells.push_back(enclave);
  EXPECT_FALSE(are_beside(cells));
}

TEST(SharedEdges, DoNotHideOverlaps) {
  const Map map(6);
  std::vector<Outline> cells = map.cells();
  // One cell is moved slightly, over its neighbor.
  cells[14] = cells[14].transformed({{1.0, 0.0}, {0.0, 1.0}, {0.01, 0.0}});
  EXPECT_FALSE(are_beside(cells));
  // A cell inside another one, without shared edges.
  cells = map.cells();
  cells.push_back(map.cell(2, 2).transformed({{0.1, 0.0}, {0.0, 0.1}, {2.3, 2.3}}));
  EXPECT_FALSE(are_beside(cells));
}

TEST(SharedEdges, NeedOppositeDirections) {
  const Map map(2);
  const std::vector<Outline> twice = {map.cell(0, 0), map.cell(0, 0)};
  EXPECT_FALSE(are_beside(twice));
  std::vector<Outline> many(500, map.cell(0, 0));
  EXPECT_FALSE(are_beside(many));
  // The hole of a ring is filled by a contour of the opposite direction.
  Outline ring = Map(1).cell(0, 0).transformed({{9.0, 0.0}, {0.0, 9.0}, {-4.0, -4.0}});
  append_contour(map.cell(0, 0), 0, true, &ring);
  EXPECT_TRUE(are_beside({ring, map.cell(0, 0)}));
}

TEST(SharedEdges, CloseOpenContours) {
  Outline low;
  low.move_to({0.0, 0.0});
  low.line_to({1.0, 0.0});
  low.line_to({1.0, 1.0});
  Outline high;
  high.move_to({0.0, 0.0});
  high.line_to({1.0, 1.0});
  high.line_to({0.0, 1.0});
  EXPECT_FALSE(are_beside({low}));
  std::vector<Outline> four = {low, high};
  for (const Outline& each : {low, high}) {
    four.push_back(each.transformed({{1.0, 0.0}, {0.0, 1.0}, {1.0, 0.0}}));
  }
  EXPECT_TRUE(are_beside(four));
  EXPECT_FALSE(are_beside({}));
  EXPECT_FALSE(are_beside({Outline()}));
}

}  // namespace
}  // namespace prefilter
