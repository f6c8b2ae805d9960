// SPDX-License-Identifier: GPL-3.0-or-later

// Approximates monotone curves by parabolas, with x a quadratic polynomial of y. Their crossings
// with lines and each other, and the areas beside them, have closed forms.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "prefilter/geometry/moments/monotone_curve.h"

namespace prefilter {

/// An arc between two heights on which x and the curve's parameter are quadratic in y, and monotone
/// up to rounding.
struct Parabola {
  Point2 low;
  Point2 high;
  double bend = 0.0;  // coefficient of y^2 in x
  double t_low = 0.0;
  double t_high = 1.0;
  double t_bend = 0.0;

  double x_at(double y) const { return at(y, low.x, high.x, bend); }
  double t_at(double y) const { return at(y, t_low, t_high, t_bend); }
  /// Height at which it reaches an x between those of its ends.
  double y_at(double x) const {
    // Relative to the lower end, bend u^2 + linear u + off = 0.
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

/// Largest area between a curve and its parabolas within a cell, as a fraction of the cell.
inline constexpr double kParabolaError = 5e-6;

/// Whether the position of a curve matters that is monotone between two points.
using IsSeen = std::function<bool(const Point2& begin, const Point2& end)>;

/// Appends the parabolas of a piece in cell coordinates, in the order of its parameter; chords if
/// it is not visible. Horizontal parts are left out.
void append_parabolas(const MonotoneCurve& piece, const IsSeen& is_seen,
                      std::vector<Parabola>* parabolas);

}  // namespace prefilter
