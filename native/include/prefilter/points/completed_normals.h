// SPDX-License-Identifier: GPL-3.0-or-later

// Completes normals that are given for only some points.
#pragma once

#include <span>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/base/run.h"

namespace prefilter {

/// Returns unit normals. A normal that is zero or not finite is replaced by the normal of the plane
/// through the `neighbours` nearest positions, oriented like the normals around it: first next to
/// given normals, then outward from these. It stays zero if no given normal can be reached that
/// way, and for points that are not finite. The result is the same for any number of threads.
/// Throws Error for no points, more than 2^31 - 1, or a different number of normals;
/// Error(kCancelled).
std::vector<Vector3> completed_normals(std::span<const Vector3> points,
                                       std::span<const Vector3> normals, int neighbours,
                                       const Run& run);

}  // namespace prefilter
