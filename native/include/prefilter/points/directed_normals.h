// SPDX-License-Identifier: GPL-3.0-or-later

// Normals that are known but for their direction.
#pragma once

#include <span>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/base/progress.h"

namespace prefilter {

/// The normals, 1 long, some reversed, so that those of near points agree, and those of each
/// connected part point outward as a whole, as those of estimate_normals without a viewpoint. Zero
/// for a normal or a point that is not finite, and for normals of length 0. The same for any number
/// of threads. Throws Error for no points, more than 2^31 - 1, or another number of normals;
/// Error(kCancelled).
std::vector<Vector3> directed_normals(std::span<const Vector3> points,
                                      std::span<const Vector3> normals, const Progress& progress,
                                      int threads);

}  // namespace prefilter
