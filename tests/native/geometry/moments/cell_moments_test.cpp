// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/geometry/moments/cell_moments.h"

#include <gtest/gtest.h>

#include <cmath>

namespace prefilter {
namespace {

// The moments of a point mass are the monomials at the point, in the coordinates of any cell.
CellMoments<2> point_mass(double x, double y) {
  CellMoments<2> moments;
  for (int b = 0; b < 3; ++b) {
    for (int a = 0; a < 3; ++a) moments.weight[3 * b + a] = std::pow(x, a) * std::pow(y, b);
  }
  for (int b = 0; b < 2; ++b) {
    for (int a = 0; a < 2; ++a) {
      moments.image[0][2 * b + a] = 3.0 * moments.weight[3 * b + a];
      moments.image[1][2 * b + a] = -moments.weight[3 * b + a];
    }
  }
  return moments;
}

double in_parent(double x, Placement place) { return place.offset + place.scale * x; }

TEST(AddChild, MovesPointMassesToTheParent) {
  const Placement places[] = {{0.0, 0.5}, {0.5, 0.5}, {0.0, 1.0}, {0.125, 0.7}};
  for (const Placement in_x : places) {
    for (const Placement in_y : places) {
      CellMoments<2> parent;
      add_child(point_mass(0.3, 0.8), in_x, in_y, &parent);
      const CellMoments<2> expected = point_mass(in_parent(0.3, in_x), in_parent(0.8, in_y));
      for (int i = 0; i < 9; ++i) EXPECT_NEAR(parent.weight[i], expected.weight[i], 1e-15);
      for (int c = 0; c < 2; ++c) {
        for (int i = 0; i < 4; ++i) EXPECT_NEAR(parent.image[c][i], expected.image[c][i], 1e-15);
      }
    }
  }
}

TEST(AddChild, UniformPartsMakeAUniformCell) {
  CellMoments<1> parent;
  const Placement parts[] = {{0.0, 0.3}, {0.3, 0.7}};
  for (const Placement in_y : parts) {
    for (const Placement in_x : parts) {
      CellMoments<1> part;
      for (int i = 0; i < 9; ++i) part.weight[i] = in_x.scale * in_y.scale * kUniformMoments[i];
      add_child(part, in_x, in_y, &parent);
    }
  }
  for (int i = 0; i < 9; ++i) EXPECT_NEAR(parent.weight[i], kUniformMoments[i], 1e-15);
}

}  // namespace
}  // namespace prefilter
