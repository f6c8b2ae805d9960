// SPDX-License-Identifier: GPL-3.0-or-later

// Exact signs of determinants of points.
#pragma once

#include "prefilter/base/geometry.h"

namespace prefilter {

/// Nonzero coordinates must have magnitudes from kSmallestExact to kLargestExact, so that no
/// product of three of their differences under- or overflows.
inline constexpr double kSmallestExact = 0x1p-300;
inline constexpr double kLargestExact = 0x1p300;

/// Side of the plane through a, b and c on which d lies: 1 where the points appear
/// counterclockwise, -1 on the other side, 0 in the plane or if the points are collinear.
int plane_side(const Vector3& a, const Vector3& b, const Vector3& c, const Vector3& d);

/// Orientation of a, b and c projected along an axis, to (y, z), (z, x) or (x, y): 1 for
/// counterclockwise, -1 for clockwise, 0 for collinear.
int turn_along(int axis, const Vector3& a, const Vector3& b, const Vector3& c);

/// Whether the points are collinear.
bool are_collinear(const Vector3& a, const Vector3& b, const Vector3& c);

}  // namespace prefilter
