// SPDX-License-Identifier: GPL-3.0-or-later

// A patch that continues the surface around it.
#pragma once

#include <span>

#include "prefilter/base/geometry.h"
#include "prefilter/base/progress.h"
#include "prefilter/voxels/solid/hole_patch.h"

namespace prefilter {

/// Divides triangles until they are about as large as the edges of the border near them, or larger
/// further away from it where there would be more than about 20000 points.
void refine_patch(HolePatch* patch, const Progress& progress);

/// Moves the points within the border. Where the patch meets the surface at less than 75 degrees,
/// it leaves the border in the surface's plane, and within bends as little as it can: parts of
/// planes and of spheres are continued as such. At the rest of the border it meets the surface at a
/// crease, as a soap film does. `normals` as for span_loop. Throws Error(kCancelled).
void fair_patch(std::span<const Vector3> normals, HolePatch* patch, const Progress& progress);

}  // namespace prefilter
