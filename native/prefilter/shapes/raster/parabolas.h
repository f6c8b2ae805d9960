// SPDX-License-Identifier: GPL-3.0-or-later

// Monotone curves as parabolas: x as a polynomial of y, so that where they pass lines and each
// other, and what lies beside them, has a closed form.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "prefilter/geometry/moments/monotone_curve.h"

namespace prefilter {

/// From its lower end; between two heights x is a polynomial of degree 2 that is monotone but for
/// what a parabola is off, and so is the curve's parameter.
struct Parabola {
  Point2 low;
  Point2 high;
  double bend = 0.0;  // of x: what y^2 is multiplied by
  double t_low = 0.0;
  double t_high = 1.0;
  double t_bend = 0.0;

  double x_at(double y) const { return at(y, low.x, high.x, bend); }
  double t_at(double y) const { return at(y, t_low, t_high, t_bend); }
  /// Where it passes an x between those of its ends.
  double y_at(double x) const {
    // From the lower end, bend u^2 + linear u + off is 0.
    const double height = high.y - low.y;
    const double linear = (high.x - low.x) / height - bend * height;
    const double off = low.x - x;
    const double root = std::sqrt(std::max(linear * linear - 4.0 * bend * off, 0.0));
    const double below = linear + (high.x >= low.x ? root : -root);
    const double u = below == 0.0 ? 0.0 : -2.0 * off / below;
    return low.y + std::clamp(u, 0.0, height);
  }

 private:
  double at(double y, double at_low, double at_high, double square) const {
    const double slope = (at_high - at_low) / (high.y - low.y);
    const double value = at_low + (y - low.y) * (slope + square * (y - high.y));
    return std::clamp(value, std::min(at_low, at_high), std::max(at_low, at_high));
  }
};

/// How much of a cell lies between a curve and its parabolas at most.
inline constexpr double kParabolaError = 5e-6;

/// Whether it matters where a curve is that is monotone from a point to another.
using IsSeen = std::function<bool(const Point2& begin, const Point2& end)>;

/// Appends the parabolas of a piece, in the order of its parameter, in the coordinates of cells;
/// chords where it is not seen. What is level is left out.
void append_parabolas(const MonotoneCurve& piece, const IsSeen& is_seen,
                      std::vector<Parabola>* parabolas);

}  // namespace prefilter
