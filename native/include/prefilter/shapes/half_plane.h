// SPDX-License-Identifier: GPL-3.0-or-later

// Clips outlines to half planes and strips.
#pragma once

#include "prefilter/base/outline.h"

namespace prefilter {

/// A linear function of the plane.
struct LinearFunction {
  Point2 slope;
  double constant = 0.0;

  double operator()(const Point2& p) const { return constant + dot(slope, p); }
};

/// The part of an outline where low <= function <= high. Winding numbers are kept there and become
/// 0 elsewhere, even if contours cross: the parts outside collapse onto the lines, where they
/// enclose nothing.
Outline clip_between(const Outline& outline, const LinearFunction& function, double low,
                     double high);

}  // namespace prefilter
