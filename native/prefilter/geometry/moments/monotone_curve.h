// SPDX-License-Identifier: GPL-3.0-or-later

// Curves divided at their turning points, into pieces on which x and y are monotone.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>

#include "prefilter/base/double_pair.h"
#include "prefilter/base/outline.h"

namespace prefilter {

/// Kinds of curves with specific formulas.
enum class CurveKind : std::uint8_t { kLine, kQuadratic, kCubic, kConic, kBezier };

/// A curve over t in [0, 1].
struct ParametricCurve {
  CurveKind kind = CurveKind::kLine;
  /// Coefficients by powers of t: of lines, quadratics, cubics, and the numerator of conics.
  std::array<Point2, 4> powers{};
  /// Coefficients of the denominator of conics, by powers of t.
  std::array<double, 3> denominator{1.0, 0.0, 0.0};
  /// Control points of Bezier curves of degree 4 and above, owned by the caller.
  std::span<const Point2> controls;

  ParametricCurve() = default;
  ParametricCurve(std::span<const Point2> controls_, double weight);

  Point2 at(double t) const {
    if (kind == CurveKind::kBezier) return bezier_at(t);
    const Point2 sum = powers[0] + t * (powers[1] + t * (powers[2] + t * powers[3]));
    if (kind != CurveKind::kConic) return sum;
    return (1.0 / (denominator[0] + t * (denominator[1] + t * denominator[2]))) * sum;
  }
  /// Evaluates at two parameters at once, with bitwise the results of at() and derivative(). Not
  /// for kBezier.
  struct Pair {
    DoublePair x;
    DoublePair y;
    DoublePair y_slope;
  };
  Pair pair_at(DoublePair t) const;
  /// The derivative by t.
  Point2 derivative(double t) const { return derivative(t, at(t)); }
  /// The same if the point at t is known.
  Point2 derivative(double t, const Point2& point) const {
    if (kind == CurveKind::kBezier) return bezier_derivative(t);
    const Point2 slope = powers[1] + t * (2.0 * powers[2] + (3.0 * t) * powers[3]);
    if (kind != CurveKind::kConic) return slope;
    const double below = denominator[0] + t * (denominator[1] + t * denominator[2]);
    const double below_slope = denominator[1] + 2.0 * t * denominator[2];
    return (1.0 / below) * (slope - below_slope * point);
  }

 private:
  Point2 bezier_at(double t) const;
  Point2 bezier_derivative(double t) const;
};

inline ParametricCurve::Pair ParametricCurve::pair_at(DoublePair t) const {
  const auto& p = powers;
  Pair pair;
  pair.x = p[0].x + t * (p[1].x + t * (p[2].x + t * p[3].x));
  pair.y = p[0].y + t * (p[1].y + t * (p[2].y + t * p[3].y));
  pair.y_slope = p[1].y + t * (2.0 * p[2].y + (3.0 * t) * p[3].y);
  if (kind != CurveKind::kConic) return pair;
  const DoublePair scale = 1.0 / (denominator[0] + t * (denominator[1] + t * denominator[2]));
  const DoublePair below_slope = denominator[1] + 2.0 * t * denominator[2];
  pair.x = scale * pair.x;
  pair.y = scale * pair.y;
  pair.y_slope = scale * (pair.y_slope - below_slope * pair.y);
  return pair;
}

/// The part of a curve from t_begin to t_end, on which x and y are monotone.
struct MonotoneCurve {
  ParametricCurve curve;
  double t_begin = 0.0;
  double t_end = 1.0;
  Point2 begin;
  Point2 end;
};

/// Maximum number of turning points of a segment.
inline constexpr int kMostTurns = 2 * Outline::kMostDegree;

/// Finds the turning points in (0, 1), in increasing order; returns their number.
int turning_points(const ParametricCurve& curve, std::span<const Point2> controls,
                   std::array<double, kMostTurns>* turns);

/// Whether a segment is divided from its end to its start. Two shapes that share an edge traverse
/// it in opposite directions; dividing it from the same end makes their contributions cancel to the
/// last bit.
bool is_cut_backward(std::span<const Point2> controls);

namespace internal {

/// Splits a conic with end weights 1 at t = 1/2 into two such conics: returns their common weight,
/// and the consecutive control points, of which they share the middle one.
double halve_conic(std::span<const Point2> controls, double weight, std::array<Point2, 5>* halves);

/// Each halving brings a weight closer to 1. Outside this range the speed along a conic varies too
/// much for quadrature.
constexpr bool is_even(double weight) { return weight == 0.0 || (weight > 0.6 && weight < 1.5); }

template <typename Use>
void for_monotone_parts(std::span<const Point2> controls, double weight, const Use& use) {
  if (!is_even(weight)) {
    std::array<Point2, 5> halves;
    const double half_weight = halve_conic(controls, weight, &halves);
    for_monotone_parts(std::span<const Point2>(halves).first(3), half_weight, use);
    for_monotone_parts(std::span<const Point2>(halves).last(3), half_weight, use);
    return;
  }
  MonotoneCurve piece;
  piece.curve = ParametricCurve(controls, weight);
  piece.begin = controls.front();
  std::array<double, kMostTurns> turns;
  const int count = turning_points(piece.curve, controls, &turns);
  for (int i = 0; i < count; ++i) {
    piece.t_end = turns[i];
    piece.end = piece.curve.at(turns[i]);
    use(piece);
    piece.t_begin = piece.t_end;
    piece.begin = piece.end;
  }
  piece.t_end = 1.0;
  piece.end = controls.back();
  use(piece);
}

}  // namespace internal

/// Calls use(const MonotoneCurve&, bool backward) for the pieces of a segment, given by its control
/// points, in the order of division.
template <typename Use>
void for_monotone_pieces(std::span<const Point2> controls, double weight, const Use& use) {
  const bool backward = is_cut_backward(controls);
  std::array<Point2, Outline::kMostDegree + 1> turned;
  if (backward) {
    std::reverse_copy(controls.begin(), controls.end(), turned.begin());
    controls = {turned.data(), controls.size()};
  }
  const auto use_turned = [&](const MonotoneCurve& piece) { use(piece, backward); };
  internal::for_monotone_parts(controls, weight, use_turned);
}
/// Parameter at which a piece reaches a value of x (axis 0) or y (axis 1), between `low` and its
/// end, which lie on opposite sides of the value.
double crossing(const MonotoneCurve& piece, int axis, double value, double low);

}  // namespace prefilter
