// SPDX-License-Identifier: GPL-3.0-or-later

// Turning points are roots of the derivative, or of its numerator for conics.
#include "prefilter/geometry/moments/monotone_curve.h"

#include <cmath>
#include <vector>

#include "prefilter/base/curve.h"

namespace prefilter {
namespace {

double component(const Point2& point, int axis) { return axis == 0 ? point.x : point.y; }

// The roots of a + b t + c t^2 in (0, 1), by a formula without cancellation.
int quadratic_roots(double a, double b, double c, double* roots) {
  int count = 0;
  const auto keep = [&](double root) {
    if (root > 0.0 && root < 1.0) roots[count++] = root;
  };
  const double discriminant = b * b - 4.0 * a * c;
  if (!(discriminant >= 0.0)) return 0;
  const double q = -0.5 * (b + std::copysign(std::sqrt(discriminant), b));
  if (c != 0.0) keep(q / c);
  if (q != 0.0) keep(a / q);
  return count;
}

}  // namespace

ParametricCurve::ParametricCurve(std::span<const Point2> controls_, double weight) {
  const std::size_t degree = controls_.size() - 1;
  const Point2& p0 = controls_[0];
  const Point2& p1 = controls_[1];
  if (degree == 1) {
    kind = CurveKind::kLine;
    powers = {p0, p1 - p0, {}, {}};
  } else if (degree == 2) {
    const Point2& p2 = controls_[2];
    if (weight == 0.0) {
      kind = CurveKind::kQuadratic;
      powers = {p0, 2.0 * (p1 - p0), p0 - 2.0 * p1 + p2, {}};
    } else {
      kind = CurveKind::kConic;
      powers = {p0, 2.0 * (weight * p1 - p0), p0 - (2.0 * weight) * p1 + p2, {}};
      denominator = {1.0, 2.0 * (weight - 1.0), 2.0 * (1.0 - weight)};
    }
  } else if (degree == 3) {
    kind = CurveKind::kCubic;
    const Point2& p2 = controls_[2];
    const Point2& p3 = controls_[3];
    powers = {p0, 3.0 * (p1 - p0), 3.0 * (p0 - 2.0 * p1 + p2), p3 - p0 + 3.0 * (p1 - p2)};
  } else {
    kind = CurveKind::kBezier;
    controls = controls_;
  }
}

Point2 ParametricCurve::bezier_at(double t) const { return point_at({controls}, t); }

Point2 ParametricCurve::bezier_derivative(double t) const { return derivative_at({controls}, t); }

int turning_points(const ParametricCurve& curve, std::span<const Point2> controls,
                   std::array<double, kMostTurns>* turns) {
  int count = 0;
  const auto& p = curve.powers;
  for (int axis = 0; axis < 2; ++axis) {
    switch (curve.kind) {
      case CurveKind::kLine:
        break;
      case CurveKind::kQuadratic: {
        const double turn = -component(p[1], axis) / (2.0 * component(p[2], axis));
        if (turn > 0.0 && turn < 1.0) (*turns)[count++] = turn;
        break;
      }
      case CurveKind::kCubic:
        count += quadratic_roots(component(p[1], axis), 2.0 * component(p[2], axis),
                                 3.0 * component(p[3], axis), turns->data() + count);
        break;
      case CurveKind::kConic: {
        // The numerator of the derivative, N' D - N D'; its cubic terms cancel.
        const auto& d = curve.denominator;
        const double n0 = component(p[0], axis);
        const double n1 = component(p[1], axis);
        const double n2 = component(p[2], axis);
        count += quadratic_roots(n1 * d[0] - n0 * d[1], 2.0 * (n2 * d[0] - n0 * d[2]),
                                 n2 * d[1] - n1 * d[2], turns->data() + count);
        break;
      }
      case CurveKind::kBezier: {
        std::vector<double> differences;
        for (std::size_t i = 0; i + 1 < controls.size(); ++i) {
          differences.push_back(component(controls[i + 1] - controls[i], axis));
        }
        std::vector<double> changes;
        append_sign_changes(differences, 0.0, 1.0, &changes);
        for (const double change : changes) {
          if (count < kMostTurns) (*turns)[count++] = change;
        }
        break;
      }
    }
  }
  std::sort(turns->begin(), turns->begin() + count);
  return count;
}

bool is_cut_backward(std::span<const Point2> controls) {
  for (std::size_t i = 0, j = controls.size() - 1; i < j; ++i, --j) {
    if (controls[i].y != controls[j].y) return controls[i].y > controls[j].y;
    if (controls[i].x != controls[j].x) return controls[i].x > controls[j].x;
  }
  return false;
}

double internal::halve_conic(std::span<const Point2> controls, double weight,
                             std::array<Point2, 5>* halves) {
  const double scale = 1.0 / (1.0 + weight);
  const Point2 left = scale * (controls[0] + weight * controls[1]);
  const Point2 right = scale * (weight * controls[1] + controls[2]);
  *halves = {controls[0], left, 0.5 * (left + right), right, controls[2]};
  return std::sqrt(0.5 * (1.0 + weight));
}

namespace {

// One coordinate of a ParametricCurve, with bitwise the same values.
class AxisCurve {
 public:
  AxisCurve(const ParametricCurve& curve, int axis) : curve_(curve), axis_(axis) {
    for (std::size_t i = 0; i < powers_.size(); ++i) powers_[i] = component(curve.powers[i], axis);
  }

  double at(double t) const {
    if (curve_.kind == CurveKind::kBezier) return component(curve_.at(t), axis_);
    const double sum = powers_[0] + t * (powers_[1] + t * (powers_[2] + t * powers_[3]));
    return curve_.kind == CurveKind::kConic ? (1.0 / below(t)) * sum : sum;
  }
  double derivative(double t) const {
    if (curve_.kind == CurveKind::kBezier) return component(curve_.derivative(t), axis_);
    const double slope = powers_[1] + t * (2.0 * powers_[2] + (3.0 * t) * powers_[3]);
    if (curve_.kind != CurveKind::kConic) return slope;
    const double below_slope = curve_.denominator[1] + 2.0 * t * curve_.denominator[2];
    return (1.0 / below(t)) * (slope - below_slope * at(t));
  }

 private:
  double below(double t) const {
    const auto& d = curve_.denominator;
    return d[0] + t * (d[1] + t * d[2]);
  }

  const ParametricCurve& curve_;
  int axis_;
  std::array<double, 4> powers_{};
};

}  // namespace

double crossing(const MonotoneCurve& piece, int axis, double value, double low) {
  const ParametricCurve& whole = piece.curve;
  double high = piece.t_end;
  if (whole.kind == CurveKind::kQuadratic || whole.kind == CurveKind::kConic) {
    const auto power = [&](std::size_t i) {
      return component(whole.powers[i], axis) - value * whole.denominator[i];
    };
    std::array<double, 2> roots;
    const int count = quadratic_roots(power(0), power(1), power(2), roots.data());
    for (int i = 0; i < count; ++i) {
      if (roots[i] > low && roots[i] < high) return roots[i];
    }
  }
  const AxisCurve curve(whole, axis);
  const bool rises = component(piece.end, axis) > component(piece.begin, axis);
  const double at_low = curve.at(low) - value;
  const double at_high = component(piece.end, axis) - value;
  double t = low;
  if (at_high != at_low) t = low - at_low * (high - low) / (at_high - at_low);
  // Newton's method, with bisection where it leaves the interval.
  constexpr int kMaxNewtonSteps = 60;
  for (int step = 0; step < kMaxNewtonSteps; ++step) {
    if (!(t > low && t < high)) t = 0.5 * (low + high);
    const double off = curve.at(t) - value;
    if (off == 0.0) return t;
    ((off > 0.0) == rises ? high : low) = t;
    const double next = t - off / curve.derivative(t);
    if (std::abs(next - t) < 1e-15) return std::clamp(next, low, high);
    t = next;
  }
  return t;
}

}  // namespace prefilter
