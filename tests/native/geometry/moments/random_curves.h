// SPDX-License-Identifier: GPL-3.0-or-later

// Curves of every kind, and reference points by Bernstein polynomials.
#pragma once

#include <cmath>
#include <random>
#include <span>
#include <vector>

#include "prefilter/base/outline.h"

namespace prefilter {

struct RandomCurve {
  std::vector<Point2> controls;
  double weight = 0.0;
};

inline RandomCurve random_curve(std::mt19937* random, int degree, double size) {
  std::uniform_real_distribution<double> place(0.0, size);
  RandomCurve curve;
  for (int i = 0; i <= degree; ++i) curve.controls.push_back({place(*random), place(*random)});
  return curve;
}

/// Lines, Bezier curves up to a high degree, and conics with weights from 1e-3 to 1e3, in turns.
inline RandomCurve any_curve(std::mt19937* random, int trial, double size) {
  constexpr int kDegrees[] = {1, 2, 3, 2, 4, 5, 8, 30, 60};
  RandomCurve curve = random_curve(random, kDegrees[trial % 9], size);
  if (trial % 9 == 3) {
    curve.weight = std::pow(10.0, std::uniform_real_distribution<double>(-3.0, 3.0)(*random));
  }
  return curve;
}

inline Point2 bernstein(std::span<const Point2> controls, double weight, double t) {
  const int degree = static_cast<int>(controls.size()) - 1;
  Point2 sum{};
  double whole = 0.0;
  double binomial = 1.0;
  for (int i = 0; i <= degree; ++i) {
    double share = binomial * std::pow(t, i) * std::pow(1.0 - t, degree - i);
    if (weight > 0.0 && i == 1) share *= weight;
    sum = sum + share * controls[i];
    whole += share;
    binomial *= static_cast<double>(degree - i) / (i + 1);
  }
  return (1.0 / whole) * sum;
}

}  // namespace prefilter
