// SPDX-License-Identifier: GPL-3.0-or-later

// Intersections of two monotone curve pieces.
#pragma once

#include <vector>

#include "prefilter/base/curve.h"

namespace prefilter {

/// Monotone part of a curve between two of its parameters; `controls` are the part's own.
struct CurvePiece {
  Curve curve;
  double from = 0.0;
  double to = 1.0;
  std::span<const Point2> controls;

  const Point2& begin() const { return controls.front(); }
  const Point2& end() const { return controls.back(); }
};

/// Whether two pieces are certainly farther apart than `precision`.
bool are_apart(const CurvePiece& a, const CurvePiece& b, double precision);
/// Whether two pieces certainly meet only where `a` ends and `b` begins.
bool meet_only_at_joint(const CurvePiece& a, const CurvePiece& b);

/// A common point, with its parameters on both curves.
struct CurveIntersection {
  double a = 0.0;
  double b = 0.0;
  Point2 point;
};

/// Appends the points where two pieces cross, and ends of one that lie on the other within
/// `precision`. Where they overlap, appends both ends of the overlap. Returns false if the search
/// exceeds a fixed number of steps.
bool append_intersections(const CurvePiece& a, const CurvePiece& b, double precision,
                          std::vector<CurveIntersection>* intersections);

/// Whether `a` overlaps `b` within `precision` between two parameters, at which it does.
bool runs_along(const CurvePiece& a, double from, double to, const CurvePiece& b, double precision);

/// The parameter of a point of the piece within `precision` of `point`, or a negative number if
/// there is none.
double parameter_near(const CurvePiece& piece, const Point2& point, double precision);

}  // namespace prefilter
