// SPDX-License-Identifier: GPL-3.0-or-later

// Where two monotone pieces of curves meet.
#pragma once

#include <vector>

#include "prefilter/base/curve.h"

namespace prefilter {

/// A monotone part of a curve. `controls` are those of the part.
struct CurvePiece {
  Curve curve;
  double from = 0.0;
  double to = 1.0;
  std::span<const Point2> controls;

  const Point2& begin() const { return controls.front(); }
  const Point2& end() const { return controls.back(); }
};

/// Whether it is certain that two pieces are farther apart than `precision`.
bool are_apart(const CurvePiece& a, const CurvePiece& b, double precision);
/// Whether it is certain that they have none but the end of `a`, where `b` begins.
bool are_apart_but_for_joint(const CurvePiece& a, const CurvePiece& b);

/// A point of both, by the parameters of their curves.
struct Meeting {
  double a = 0.0;
  double b = 0.0;
  Point2 point;
};

/// Appends where two pieces cross, and where an end of one lies on the other, up to `precision`.
/// Where they run along each other, that is where they begin and cease to. Returns false where
/// there is no telling within a fixed number of steps.
bool append_meetings(const CurvePiece& a, const CurvePiece& b, double precision,
                     std::vector<Meeting>* meetings);

/// Whether the part of `a` between two parameters runs along `b`, up to `precision`. Its ends do.
bool runs_along(const CurvePiece& a, double from, double to, const CurvePiece& b, double precision);

/// The parameter of the piece's point nearest to `point`, where that is within `precision`; else a
/// negative number.
double parameter_near(const CurvePiece& piece, const Point2& point, double precision);

}  // namespace prefilter
