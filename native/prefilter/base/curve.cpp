// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/base/curve.h"

#include <algorithm>
#include <cmath>

#include "prefilter/base/elementary.h"

namespace prefilter {
namespace {

constexpr int kMaxChords = 1 << 14;

// De Casteljau's algorithm: writes the control points of the part before t to `first`, and leaves
// those of the part after t in `points`.
template <typename Point>
void split(std::span<Point> points, double t, Point* first) {
  const std::size_t count = points.size();
  for (std::size_t level = 0; level < count; ++level) {
    first[level] = points[0];
    for (std::size_t i = 0; i + 1 < count - level; ++i) {
      points[i] = (1.0 - t) * points[i] + t * points[i + 1];
    }
  }
}

// A conic's control point times its weight, and the weight.
struct Weighted {
  Point2 point;
  double weight;
};
Weighted operator+(const Weighted& a, const Weighted& b) {
  return {a.point + b.point, a.weight + b.weight};
}
Weighted operator*(double s, const Weighted& a) { return {s * a.point, s * a.weight}; }

std::array<Weighted, 3> weighted(const Curve& conic) {
  return {Weighted{conic.controls[0], 1.0},
          Weighted{conic.weight * conic.controls[1], conic.weight},
          Weighted{conic.controls[2], 1.0}};
}

// Restricts control points to the part between two parameters; `room` has space for as many points.
template <typename Point>
void keep_part(std::span<Point> points, double from, double to, Point* room) {
  if (to < 1.0) {
    split(points, to, room);
    std::copy_n(room, points.size(), points.begin());
  }
  if (from > 0.0) split(points, from / to, room);
}

// The error of a chord is at most the second derivative times the squared parameter step / 8.
std::size_t line_count(const Curve& curve, double tolerance) {
  const auto& controls = curve.controls;
  double largest = 0.0;
  for (std::size_t i = 0; i + 2 < controls.size(); ++i) {
    const Point2 bend = controls[i] - 2.0 * controls[i + 1] + controls[i + 2];
    largest = std::max(largest, elementary::hypot(bend.x, bend.y));
  }
  const double degree = curve.degree();
  const double lines = std::ceil(std::sqrt(degree * (degree - 1.0) / 8.0 * largest / tolerance));
  return static_cast<std::size_t>(std::clamp(lines, 1.0, static_cast<double>(kMaxChords)));
}

// The distance of the curve from its chord is at most that of its control point, times w / (1 + w).
void flatten_conic(const std::array<Weighted, 3>& conic, double tolerance, int depth,
                   std::vector<Point2>* points) {
  const Point2 begin = (1.0 / conic[0].weight) * conic[0].point;
  const Point2 end = (1.0 / conic[2].weight) * conic[2].point;
  const Point2 middle = (1.0 / conic[1].weight) * conic[1].point;
  const double weight = conic[1].weight / std::sqrt(conic[0].weight * conic[2].weight);
  const Point2 bend = middle - 0.5 * (begin + end);
  if (depth == 0 || elementary::hypot(bend.x, bend.y) * weight <= tolerance * (1.0 + weight)) {
    points->push_back(end);
    return;
  }
  std::array<Weighted, 3> first;
  std::array<Weighted, 3> second = conic;
  split(std::span<Weighted>(second), 0.5, first.data());
  flatten_conic(first, tolerance, depth - 1, points);
  flatten_conic(second, tolerance, depth - 1, points);
}

// The root in (0, 1) of a polynomial whose Bernstein coefficients change sign once, so that there
// is exactly one: Newton's method, with bisection where it leaves the interval.
double only_root(std::span<const double> coefficients) {
  const std::size_t size = coefficients.size();
  const double first =
      *std::find_if(coefficients.begin(), coefficients.end(), [](double c) { return c != 0.0; });
  double low = 0.0;
  double high = 1.0;
  double t = 0.5;
  constexpr int kMaxNewtonSteps = 80;
  for (int step = 0; step < kMaxNewtonSteps; ++step) {
    std::array<double, Outline::kMostDegree + 1> values;
    std::copy(coefficients.begin(), coefficients.end(), values.begin());
    double slope = 0.0;
    for (std::size_t left = size - 1; left > 0; --left) {
      slope = static_cast<double>(size - 1) * (values[1] - values[0]);
      for (std::size_t i = 0; i < left; ++i) values[i] += t * (values[i + 1] - values[i]);
    }
    if (values[0] == 0.0) return t;
    ((values[0] < 0.0) == (first < 0.0) ? low : high) = t;
    const double by_slope = t - values[0] / slope;
    const double next = by_slope > low && by_slope < high ? by_slope : 0.5 * (low + high);
    if (std::abs(next - t) < 1e-15) return next;
    t = next;
  }
  return t;
}

}  // namespace

Point2 point_at(const Curve& curve, double t) {
  if (t == 0.0) return curve.begin();
  if (t == 1.0) return curve.end();
  if (curve.weight > 0.0) {
    std::array<Weighted, 3> conic = weighted(curve);
    for (std::size_t level = 2; level > 0; --level) {
      for (std::size_t i = 0; i < level; ++i) conic[i] = (1.0 - t) * conic[i] + t * conic[i + 1];
    }
    return (1.0 / conic[0].weight) * conic[0].point;
  }
  const auto& p = curve.controls;
  const double u = 1.0 - t;
  switch (curve.degree()) {
    case 1:
      return u * p[0] + t * p[1];
    case 2:
      return u * (u * p[0] + t * p[1]) + t * (u * p[1] + t * p[2]);
    case 3: {
      const Point2 middle = u * p[1] + t * p[2];
      return u * (u * (u * p[0] + t * p[1]) + t * middle) +
             t * (u * middle + t * (u * p[2] + t * p[3]));
    }
    default:
      break;
  }
  ControlPoints points(p);
  for (std::size_t level = p.size() - 1; level > 0; --level) {
    for (std::size_t i = 0; i < level; ++i) points[i] = u * points[i] + t * points[i + 1];
  }
  return points[0];
}

Point2 derivative_at(const Curve& curve, double t) {
  if (curve.degree() == 1) return curve.end() - curve.begin();
  if (curve.weight > 0.0) {
    const auto& p = curve.controls;
    const double u = 1.0 - t;
    const double w = curve.weight;
    const double whole = u * u + 2.0 * t * u * w + t * t;
    const Point2 numerator = (2.0 * u * u * w) * (p[1] - p[0]) + (2.0 * t * u) * (p[2] - p[0]) +
                             (2.0 * t * t * w) * (p[2] - p[1]);
    return (1.0 / (whole * whole)) * numerator;
  }
  ControlPoints steps(curve.controls);
  const auto degree = static_cast<std::size_t>(curve.degree());
  for (std::size_t i = 0; i < degree; ++i) steps[i] = steps[i + 1] - steps[i];
  for (std::size_t level = degree - 1; level > 0; --level) {
    for (std::size_t i = 0; i < level; ++i) steps[i] = (1.0 - t) * steps[i] + t * steps[i + 1];
  }
  return static_cast<double>(degree) * steps[0];
}

void append_curve(const Curve& curve, bool reversed, const Point2& end, Outline* outline) {
  if (curve.degree() == 1) {
    outline->line_to(end);
    return;
  }
  ControlPoints points(curve.controls);
  if (reversed) std::reverse(points.span().begin(), points.span().end());
  points[points.size() - 1] = end;
  if (curve.weight > 0.0) {
    outline->conic_to(points[1], curve.weight, end);
  } else {
    outline->curve_to(points.span().subspan(1));
  }
}

void append_contour(const Outline& from, std::size_t index, bool reversed, Outline* to) {
  const auto segments = from.contour(index);
  if (!reversed) {
    to->move_to(from.begin_of(index));
    for (const Outline::Segment& segment : segments) {
      append_curve(curve_of(from, segment), false, from.controls(segment).back(), to);
    }
  } else {
    to->move_to(from.controls(segments.back()).back());
    for (auto segment = segments.rbegin(); segment != segments.rend(); ++segment) {
      append_curve(curve_of(from, *segment), true, from.controls(*segment).front(), to);
    }
  }
  to->close();
}

PartOfCurve::PartOfCurve(const Curve& curve, double from, double to)
    : points_(curve.controls), weight_(curve.weight) {
  if (curve.weight > 0.0) {
    std::array<Weighted, 3> conic = weighted(curve);
    std::array<Weighted, 3> room;
    keep_part(std::span<Weighted>(conic), from, to, room.data());
    for (std::size_t i = 0; i < 3; ++i) points_[i] = (1.0 / conic[i].weight) * conic[i].point;
    weight_ = conic[1].weight / std::sqrt(conic[0].weight * conic[2].weight);
    return;
  }
  ControlPoints room(curve.controls);
  keep_part(points_.span(), from, to, room.span().data());
}

void append_flattened(const Curve& curve, double tolerance, std::vector<Point2>* points) {
  if (curve.weight > 0.0) {
    flatten_conic(weighted(curve), tolerance, 14, points);
    points->back() = curve.end();
    return;
  }
  const std::size_t lines = line_count(curve, tolerance);
  for (std::size_t i = 1; i < lines; ++i) {
    points->push_back(point_at(curve, static_cast<double>(i) / static_cast<double>(lines)));
  }
  points->push_back(curve.end());
}

// A polynomial has at most as many roots as its Bernstein coefficients have sign changes.
void append_sign_changes(std::span<const double> coefficients, double from, double to,
                         std::vector<double>* changes) {
  int count = 0;
  double last = 0.0;
  for (const double coefficient : coefficients) {
    if (coefficient == 0.0) continue;
    if (last != 0.0 && (coefficient < 0.0) != (last < 0.0)) ++count;
    last = coefficient;
  }
  if (count == 0) return;
  if (count == 1) {
    changes->push_back(from + (to - from) * only_root(coefficients));
    return;
  }
  const double middle = 0.5 * (from + to);
  if (to - from < 1e-15 || middle <= from || middle >= to) {
    changes->push_back(middle);
    return;
  }
  const std::size_t size = coefficients.size();
  std::array<double, Outline::kMostDegree + 1> first;
  std::array<double, Outline::kMostDegree + 1> second;
  std::copy(coefficients.begin(), coefficients.end(), second.begin());
  split(std::span<double>(second.data(), size), 0.5, first.data());
  append_sign_changes({first.data(), size}, from, middle, changes);
  if (second[0] == 0.0) changes->push_back(middle);
  append_sign_changes({second.data(), size}, middle, to, changes);
}

}  // namespace prefilter
