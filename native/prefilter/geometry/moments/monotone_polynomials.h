// SPDX-License-Identifier: GPL-3.0-or-later

// Monotone pieces of quadratics and cubics as polynomials.
#pragma once

#include <array>
#include <cmath>

#include "prefilter/geometry/moments/monotone_curve.h"
#include "prefilter/geometry/moments/monotone_roots.h"

namespace prefilter {

/// Polynomials of s in [0, 1] over a piece: x relative to a column, y, and the integral of x dy.
struct MonotonePolynomials {
  CubicPowers x{};
  CubicPowers y{};
  std::array<double, 6> area{};  // coefficients of s^1 to s^6
  double column = 0.0;

  /// From a piece of a quadratic or a cubic.
  explicit MonotonePolynomials(const MonotoneCurve& piece) : column(std::floor(piece.begin.x)) {
    const auto& powers = piece.curve.powers;
    const double t = piece.t_begin;
    const double w = piece.t_end - piece.t_begin;
    // p(t + w s), except that the start point is exact.
    const Point2 p1 = w * (powers[1] + t * (2.0 * powers[2] + (3.0 * t) * powers[3]));
    const Point2 p2 = (w * w) * (powers[2] + (3.0 * t) * powers[3]);
    const Point2 p3 = (w * w * w) * powers[3];
    x = {piece.begin.x - column, p1.x, p2.x, p3.x};
    y = {piece.begin.y, p1.y, p2.y, p3.y};
    area = {x[0] * y[1],
            (x[1] * y[1] + 2.0 * x[0] * y[2]) * (1.0 / 2.0),
            (x[2] * y[1] + 2.0 * x[1] * y[2] + 3.0 * x[0] * y[3]) * (1.0 / 3.0),
            (x[3] * y[1] + 2.0 * x[2] * y[2] + 3.0 * x[1] * y[3]) * (1.0 / 4.0),
            (2.0 * x[3] * y[2] + 3.0 * x[2] * y[3]) * (1.0 / 5.0),
            x[3] * y[3] * (1.0 / 2.0)};
  }
};

}  // namespace prefilter
