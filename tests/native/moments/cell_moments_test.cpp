#include "prefilter/moments/cell_moments.h"

#include <gtest/gtest.h>

#include <cmath>

namespace prefilter {
namespace {

// The moments of a point mass are the monomials at the point, in whichever cell's coordinates.
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

double in_parent(double x, Half half) {
  if (half == Half::kWhole) return x;
  return half == Half::kLow ? x / 2 : (x + 1) / 2;
}

TEST(AddChild, MovesPointMassesToTheParent) {
  const Half halves[] = {Half::kLow, Half::kHigh, Half::kWhole};
  for (const Half half_x : halves) {
    for (const Half half_y : halves) {
      CellMoments<2> parent;
      add_child(point_mass(0.3, 0.8), half_x, half_y, &parent);
      const CellMoments<2> expected = point_mass(in_parent(0.3, half_x), in_parent(0.8, half_y));
      for (int i = 0; i < 9; ++i) EXPECT_NEAR(parent.weight[i], expected.weight[i], 1e-15);
      for (int c = 0; c < 2; ++c) {
        for (int i = 0; i < 4; ++i) EXPECT_NEAR(parent.image[c][i], expected.image[c][i], 1e-15);
      }
    }
  }
}

TEST(AddChild, FourUniformQuartersMakeAUniformCell) {
  CellMoments<1> quarter;
  for (int i = 0; i < 9; ++i) quarter.weight[i] = 0.25 * kUniformMoments[i];
  CellMoments<1> parent;
  for (const Half half_y : {Half::kLow, Half::kHigh}) {
    for (const Half half_x : {Half::kLow, Half::kHigh}) add_child(quarter, half_x, half_y, &parent);
  }
  for (int i = 0; i < 9; ++i) EXPECT_NEAR(parent.weight[i], kUniformMoments[i], 1e-15);
}

}  // namespace
}  // namespace prefilter
