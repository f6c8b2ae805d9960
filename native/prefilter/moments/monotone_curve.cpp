#include "prefilter/moments/monotone_curve.h"

#include <cmath>
#include <vector>

namespace prefilter {
namespace {

double component(const Point2& point, int axis) { return axis == 0 ? point.x : point.y; }

// A Bezier curve and its derivative by de Casteljau's scheme, which no degree makes unstable.
void evaluate_bezier(std::span<const Point2> controls, double t, Point2* point, Point2* slope) {
  std::array<Point2, Outline::kMostDegree + 1> work;
  std::copy(controls.begin(), controls.end(), work.begin());
  const int degree = static_cast<int>(controls.size()) - 1;
  for (int level = degree; level > 1; --level) {
    for (int i = 0; i < level; ++i) work[i] = (1.0 - t) * work[i] + t * work[i + 1];
  }
  *slope = static_cast<double>(degree) * (work[1] - work[0]);
  *point = (1.0 - t) * work[0] + t * work[1];
}

// The roots in (0, 1) of a + b t + c t^2, by a form that does not cancel.
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

// The places where a polynomial in Bernstein's basis changes its sign, by halving until it has one
// change at the most.
void sign_changes(std::vector<double> values, double low, double high,
                  std::array<double, kMostTurns>* turns, int* count) {
  int changes = 0;
  double last = 0.0;
  for (const double value : values) {
    if (value == 0.0) continue;
    changes += last != 0.0 && (value > 0.0) != (last > 0.0) ? 1 : 0;
    last = value;
  }
  if (changes == 0) return;
  const double middle = 0.5 * (low + high);
  if (high - low < 1e-15 || middle == low || middle == high) {
    if (*count < kMostTurns) (*turns)[(*count)++] = middle;
    return;
  }
  std::vector<double> left;
  std::vector<double> right = std::move(values);
  const std::size_t size = right.size();
  for (std::size_t level = size; level > 0; --level) {
    left.push_back(right.front());
    for (std::size_t i = 0; i + 1 < level; ++i) right[i] = 0.5 * (right[i] + right[i + 1]);
  }
  // What is left in `right` is the second half, in order.
  if (right.front() == 0.0 && left.size() > 1 && right.size() > 1 &&
      (left[size - 2] > 0.0) != (right[1] > 0.0) && *count < kMostTurns) {
    (*turns)[(*count)++] = middle;
  }
  sign_changes(std::move(left), low, middle, turns, count);
  sign_changes(std::move(right), middle, high, turns, count);
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

Point2 ParametricCurve::at(double t) const {
  if (kind == CurveKind::kBezier) {
    Point2 point;
    Point2 slope;
    evaluate_bezier(controls, t, &point, &slope);
    return point;
  }
  const Point2 sum = powers[0] + t * (powers[1] + t * (powers[2] + t * powers[3]));
  if (kind != CurveKind::kConic) return sum;
  return (1.0 / (denominator[0] + t * (denominator[1] + t * denominator[2]))) * sum;
}

Point2 ParametricCurve::derivative(double t) const {
  if (kind == CurveKind::kBezier) {
    Point2 point;
    Point2 slope;
    evaluate_bezier(controls, t, &point, &slope);
    return slope;
  }
  const Point2 slope = powers[1] + t * (2.0 * powers[2] + (3.0 * t) * powers[3]);
  if (kind != CurveKind::kConic) return slope;
  const double below = denominator[0] + t * (denominator[1] + t * denominator[2]);
  const double below_slope = denominator[1] + 2.0 * t * denominator[2];
  return (1.0 / below) * (slope - below_slope * at(t));
}

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
        sign_changes(std::move(differences), 0.0, 1.0, turns, &count);
        break;
      }
    }
  }
  std::sort(turns->begin(), turns->begin() + count);
  return count;
}

bool is_cut_backwards(std::span<const Point2> controls) {
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

double crossing(const MonotoneCurve& piece, int axis, double value, double low) {
  const ParametricCurve& curve = piece.curve;
  double high = piece.t_end;
  const bool rises = component(piece.end, axis) > component(piece.begin, axis);
  const double at_low = component(curve.at(low), axis) - value;
  const double at_high = component(piece.end, axis) - value;
  double t = low;
  if (at_high != at_low) t = low - at_low * (high - low) / (at_high - at_low);
  // Newton's steps, or halves of the interval where these leave it.
  constexpr int kMostSteps = 60;
  for (int step = 0; step < kMostSteps; ++step) {
    if (!(t > low && t < high)) t = 0.5 * (low + high);
    const double off = component(curve.at(t), axis) - value;
    if (off == 0.0) return t;
    ((off > 0.0) == rises ? high : low) = t;
    const double next = t - off / component(curve.derivative(t), axis);
    if (std::abs(next - t) < 1e-15) return std::clamp(next, low, high);
    t = next;
  }
  return t;
}

}  // namespace prefilter
