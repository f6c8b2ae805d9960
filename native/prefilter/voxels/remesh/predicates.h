// SPDX-License-Identifier: GPL-3.0-or-later

// Signs of determinants of points, without rounding errors.
#pragma once

#include "prefilter/base/geometry.h"

namespace prefilter {

/// Coordinates have to be 0 or at least kSmallestExact and at most kLargestExact in size, so that
/// no product of three of their differences under- or overflows.
inline constexpr double kSmallestExact = 0x1p-300;
inline constexpr double kLargestExact = 0x1p300;

/// The side of the plane through a, b and c that d is on: 1 for the one that sees them
/// counter-clockwise, -1 for the other one, 0 in the plane, or where the three are on one line.
int plane_side(const Vector3& a, const Vector3& b, const Vector3& c, const Vector3& d);

/// Seen along an axis, that is as (y, z), (z, x) or (x, y): 1 where a, b and c are
/// counter-clockwise, -1 where they are clockwise, 0 on one line.
int turn_along(int axis, const Vector3& a, const Vector3& b, const Vector3& c);

/// Whether the three points are on one line.
bool are_on_one_line(const Vector3& a, const Vector3& b, const Vector3& c);

}  // namespace prefilter
