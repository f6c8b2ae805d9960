// SPDX-License-Identifier: GPL-3.0-or-later

// Nearest points of triangles.
#pragma once

#include "prefilter/base/geometry.h"

namespace prefilter {

/// Weights of a triangle's corners for its point nearest to p: nonnegative, with sum 1. A triangle
/// of zero area acts as a segment or a point.
Vector3 nearest_weights(const Vector3& p, const Vector3& a, const Vector3& b, const Vector3& c);

}  // namespace prefilter
