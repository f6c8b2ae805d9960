// SPDX-License-Identifier: GPL-3.0-or-later

// Section 1.1: the jinc filter with the window of figure 1.6.
#include "prefilter/images/filters/windowed_jinc.h"

#include <array>
#include <cassert>
#include <cmath>
#include <numbers>

#include "prefilter/base/elementary.h"

namespace prefilter {
namespace {

using std::numbers::pi;

// Below this, the omitted terms of the series are smaller than rounding.
constexpr double kMaxSeriesArgument = 1e-3;

double smooth_sinc(double x) {
  const double angle = pi * x;
  if (std::abs(angle) < kMaxSeriesArgument)
    return 1.0 - angle * angle * (1.0 - angle * angle / 20.0) / 6.0;
  return elementary::sin(angle) / angle;
}

double jinc(double r) {
  const double x = pi * r;
  if (std::abs(x) < kMaxSeriesArgument) return 0.5 - x * x * (1.0 - x * x / 24.0) / 16.0;
  return bessel_j1(x) / x;
}

}  // namespace

// Miller's algorithm: J_k decays quickly beyond k = x. Starting there with arbitrary values, the
// recurrence J_{k-1} = 2 k / x J_k - J_{k+1} is stable downwards and yields all J_k up to a factor,
// which is determined by J_0 + 2 (J_2 + J_4 + ...) = 1.
double bessel_j1(double x) {
  const double size = std::abs(x);
  if (size < kMaxSeriesArgument) return 0.5 * x * (1.0 - x * x * (1.0 - x * x / 24.0) / 8.0);
  // The last term is for large x, where the decay starts slowly.
  const int start = 2 * static_cast<int>((size + 24.0 + 6.0 * elementary::cbrt(size)) / 2.0);
  double above = 0.0;
  double here = 1e-300;
  double evens = 0.0;
  for (int k = start; k > 0; --k) {
    if (k % 2 == 0) evens += here;
    const double below = 2.0 * k / size * here - above;
    above = here;
    here = below;
    if (std::abs(here) > 1e200) {
      constexpr double kShrink = 1e-200;
      above *= kShrink;
      here *= kShrink;
      evens *= kShrink;
    }
  }
  const double value = above / (here + 2.0 * evens);
  return x < 0.0 ? -value : value;
}

WindowedJinc::WindowedJinc(double radius) : radius_(radius) {
  assert(radius > 0.0);
  // Eight-point Gauss rule, on intervals of at most half a texel.
  constexpr std::array<double, 4> kPoints = {0.1834346424956498, 0.5255324099163290,
                                             0.7966664774136267, 0.9602898564975363};
  constexpr std::array<double, 4> kWeights = {0.3626837833783620, 0.3137066458778873,
                                              0.2223810344533745, 0.1012285362903763};
  const int intervals = static_cast<int>(std::ceil(2.0 * radius));
  const double half = 0.5 * radius / intervals;
  double integral = 0.0;
  for (int i = 0; i < intervals; ++i) {
    for (int k = 0; k < 4; ++k) {
      for (const double side : {-1.0, 1.0}) {
        const double r = (2.0 * i + 1.0 + side * kPoints[k]) * half;
        integral += kWeights[k] * half * 2.0 * pi * r * (*this)(r);
      }
    }
  }
  scale_ = 1.0 / integral;
}

double WindowedJinc::operator()(double distance) const {
  if (!(distance < radius_)) return 0.0;
  return scale_ * jinc(distance) * smooth_sinc(distance / radius_);
}

double windowed_jinc(double distance, double radius) { return WindowedJinc(radius)(distance); }

}  // namespace prefilter
