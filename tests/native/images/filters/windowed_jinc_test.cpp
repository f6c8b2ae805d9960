// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/images/filters/windowed_jinc.h"

#include <gtest/gtest.h>

#include <cmath>
#include <initializer_list>
#include <numbers>

namespace prefilter {
namespace {

using std::numbers::pi;

// Bessel's integral: (1 / pi) times the integral over [0, pi] of cos(t - x sin t). The trapezoidal
// rule converges fast for periodic functions.
double bessel_integral(double x) {
  constexpr int kSteps = 1024;
  double sum = 0.5 * (std::cos(0.0) + std::cos(pi));
  for (int k = 1; k < kSteps; ++k) {
    const double t = pi * k / kSteps;
    sum += std::cos(t - x * std::sin(t));
  }
  return sum / kSteps;
}

TEST(BesselJ1, IsBesselsIntegral) {
  for (double x = -130.0; x < 130.0; x += 0.37) {
    EXPECT_NEAR(bessel_j1(x), bessel_integral(x), 2e-14) << x;
  }
  for (const double x : {0.0, 1e-12, 9.99e-4, 1.01e-3, 0.1, 400.0}) {
    EXPECT_NEAR(bessel_j1(x), bessel_integral(x), 2e-14) << x;
    EXPECT_EQ(bessel_j1(-x), -bessel_j1(x)) << x;
  }
}

// Values from scipy.special.j1 and scipy.integrate.quad.
TEST(WindowedJinc, HasTheValuesOfItsDefinition) {
  struct Expected {
    double radius;
    double distance;
    double value;
  };
  for (const auto& [radius, distance, value] : std::initializer_list<Expected>{
           {2.0, 0.0, 0.7454825823096309},
           {2.0, 0.5, 0.48438539386935753},
           {2.0, 1.7, -0.01642718590083963},
           {3.0, 0.0, 0.805863240842646},
           {3.0, 1e-9, 0.805863240842646},
           {3.0, 0.25, 0.7368182286561964},
           {3.0, 1.0, 0.12075407382484059},
           {3.0, 1.2196698912665045, 0.0},
           {3.0, 2.5, 0.008279939560437932},
           {10.0, 2.5, 0.03790904206713766},
       }) {
    EXPECT_NEAR(windowed_jinc(distance, radius), value, 1e-13) << radius << ", " << distance;
  }
}

TEST(WindowedJinc, EndsAtItsRadius) {
  for (const double radius : {0.5, 2.0, 3.0}) {
    const WindowedJinc filter(radius);
    EXPECT_EQ(filter(radius), 0.0);
    EXPECT_EQ(filter(radius + 1.0), 0.0);
    EXPECT_NEAR(filter(radius - 1e-9), 0.0, 1e-8);
  }
}

}  // namespace
}  // namespace prefilter
