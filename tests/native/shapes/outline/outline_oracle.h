// SPDX-License-Identifier: GPL-3.0-or-later

// Brute-force regions of outlines, independent of the library.
#pragma once

#include <cmath>
#include <random>
#include <vector>

#include "prefilter/base/outline.h"

namespace prefilter::outline_oracle {

/// A point of a segment, by Bernstein polynomials.
inline Point2 bernstein(const Outline& outline, const Outline::Segment& segment, double t) {
  const auto controls = outline.controls(segment);
  Point2 sum{};
  double whole = 0.0;
  double binomial = 1.0;
  for (int i = 0; i <= segment.degree; ++i) {
    double factor = binomial * std::pow(t, i) * std::pow(1.0 - t, segment.degree - i);
    binomial *= static_cast<double>(segment.degree - i) / (i + 1.0);
    if (segment.weight > 0.0 && i == 1) factor *= segment.weight;
    sum = sum + factor * controls[static_cast<std::size_t>(i)];
    whole += factor;
  }
  return (1.0 / whole) * sum;
}

using Chain = std::vector<Point2>;  // the last point is the first

/// Every contour as a closed chain of lines, `steps` for a curve.
inline std::vector<Chain> fine_chains(const Outline& outline, int steps = 400) {
  std::vector<Chain> chains;
  for (std::size_t c = 0; c < outline.contour_count(); ++c) {
    Chain chain = {outline.begin_of(c)};
    for (const Outline::Segment& segment : outline.contour(c)) {
      const int count = segment.degree == 1 ? 1 : steps;
      for (int i = 1; i < count; ++i) {
        chain.push_back(bernstein(outline, segment, static_cast<double>(i) / count));
      }
      chain.push_back(outline.controls(segment).back());
    }
    chain.push_back(chain.front());
    chains.push_back(chain);
  }
  return chains;
}

inline int winding(const std::vector<Chain>& chains, const Point2& p) {
  int sum = 0;
  for (const Chain& chain : chains) {
    for (std::size_t i = 0; i + 1 < chain.size(); ++i) {
      const Point2& a = chain[i];
      const Point2& b = chain[i + 1];
      if ((a.y <= p.y) == (b.y <= p.y)) continue;
      const double x = a.x + (p.y - a.y) / (b.y - a.y) * (b.x - a.x);
      if (x > p.x) sum += b.y > a.y ? 1 : -1;
    }
  }
  return sum;
}

inline bool filled(int winding, FillRule rule) {
  return rule == FillRule::kNonzero ? winding != 0 : winding % 2 != 0;
}

inline double distance(const std::vector<Chain>& chains, const Point2& p) {
  double best = HUGE_VAL;
  for (const Chain& chain : chains) {
    for (std::size_t i = 0; i + 1 < chain.size(); ++i) {
      const Point2 along = chain[i + 1] - chain[i];
      const double square = dot(along, along);
      const double t =
          square > 0.0 ? std::min(1.0, std::max(0.0, dot(p - chain[i], along) / square)) : 0.0;
      const Point2 off = p - (chain[i] + t * along);
      best = std::min(best, std::hypot(off.x, off.y));
    }
  }
  return best;
}

inline double area(const std::vector<Chain>& chains) {
  double sum = 0.0;
  for (const Chain& chain : chains) {
    for (std::size_t i = 0; i + 1 < chain.size(); ++i) {
      sum += 0.5 * cross(chain[i] - chain[0], chain[i + 1] - chain[0]);
    }
  }
  return sum;
}

/// Area by Richardson extrapolation: the error of chords is quadratic in their length.
inline double area(const Outline& outline) {
  return (4.0 * area(fine_chains(outline, 400)) - area(fine_chains(outline, 200))) / 3.0;
}

/// Random points of a box slightly larger than the outline's, at least `clearance` away from the
/// curves.
inline std::vector<Point2> random_points(const Outline& outline, int count, double clearance,
                                         unsigned seed) {
  Box2 box = control_box(outline);
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(-0.05, 1.05);
  const std::vector<Chain> chains = fine_chains(outline);
  std::vector<Point2> points;
  while (static_cast<int>(points.size()) < count) {
    const Point2 point = {box.low.x + unit(random) * (box.high.x - box.low.x),
                          box.low.y + unit(random) * (box.high.y - box.low.y)};
    if (distance(chains, point) > clearance) points.push_back(point);
  }
  return points;
}

inline Outline polygon(const std::vector<Point2>& points) {
  Outline outline;
  outline.move_to(points.front());
  for (std::size_t i = 1; i < points.size(); ++i) outline.line_to(points[i]);
  outline.close();
  return outline;
}

/// A counter-clockwise circle of four conics.
inline Outline circle(const Point2& center, double radius) {
  Outline outline;
  const std::array<Point2, 4> axes = {{{1, 0}, {0, 1}, {-1, 0}, {0, -1}}};
  outline.move_to(center + radius * axes[0]);
  for (std::size_t i = 0; i < 4; ++i) {
    const Point2& from = axes[i];
    const Point2& to = axes[(i + 1) % 4];
    outline.conic_to(center + radius * (from + to), std::sqrt(0.5), center + radius * to);
  }
  outline.close();
  return outline;
}

inline Outline reversed(const Outline& outline) {
  Outline result;
  for (std::size_t c = 0; c < outline.contour_count(); ++c) {
    const auto segments = outline.contour(c);
    if (segments.empty()) {
      result.move_to(outline.begin_of(c));
      continue;
    }
    result.move_to(outline.controls(segments.back()).back());
    for (auto segment = segments.rbegin(); segment != segments.rend(); ++segment) {
      const auto controls = outline.controls(*segment);
      std::vector<Point2> points(controls.rbegin() + 1, controls.rend());
      if (segment->weight > 0.0) {
        result.conic_to(points[0], segment->weight, points[1]);
      } else {
        result.curve_to(points);
      }
    }
    if (outline.is_closed(c)) result.close();
  }
  return result;
}

}  // namespace prefilter::outline_oracle
