// SPDX-License-Identifier: GPL-3.0-or-later

// Normals of points of which only some have one.
#pragma once

#include <span>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/base/progress.h"

namespace prefilter {

/// The normals, 1 long; where one is zero or not finite, that of the plane through the `neighbours`
/// nearest positions, on the side that the normals around it are on: first where there are some
/// that were given, then from these on. Still zero where no given normal can be reached that way,
/// and for points that are not finite. The same for any number of threads. Throws Error for no
/// points, more than 2^31 - 1, or another number of normals; Error(kCancelled).
std::vector<Vector3> completed_normals(std::span<const Vector3> points,
                                       std::span<const Vector3> normals, int neighbours,
                                       const Progress& progress, int threads);

}  // namespace prefilter
