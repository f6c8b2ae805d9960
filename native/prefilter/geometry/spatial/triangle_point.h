// SPDX-License-Identifier: GPL-3.0-or-later

// Points of triangles.
#pragma once

#include "prefilter/base/geometry.h"

namespace prefilter {

/// The weights of a triangle's corners at its point nearest to p: 0 and up, of sum 1. A triangle of
/// zero area is a segment or a point.
Vector3 nearest_weights(const Vector3& p, const Vector3& a, const Vector3& b, const Vector3& c);

}  // namespace prefilter
