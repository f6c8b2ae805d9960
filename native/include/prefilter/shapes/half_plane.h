// SPDX-License-Identifier: GPL-3.0-or-later

// The part of an outline on one side of a line.
#pragma once

#include "prefilter/base/outline.h"

namespace prefilter {

/// A linear function of the plane.
struct LinearFunction {
  Point2 slope;
  double constant = 0.0;

  double operator()(const Point2& p) const { return constant + dot(slope, p); }
};

/// What an outline encloses where low <= function <= high. Winding numbers stay what they are
/// there and are 0 elsewhere, whether or not contours cross: what lies beyond is drawn together to
/// the line, where it encloses nothing.
Outline clip_between(const Outline& outline, const LinearFunction& function, double low,
                     double high);

}  // namespace prefilter
