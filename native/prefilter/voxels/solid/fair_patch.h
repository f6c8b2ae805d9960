// SPDX-License-Identifier: GPL-3.0-or-later

// Refines and fairs a patch so that it continues the surface around it.
#pragma once

#include <span>

#include "prefilter/base/geometry.h"
#include "prefilter/base/run.h"
#include "prefilter/voxels/solid/hole_patch.h"

namespace prefilter {

/// Divides triangles until they are about as large as the nearby border edges, or larger toward the
/// middle where there would be more than about 20000 points.
void refine_patch(HolePatch* patch, const Run& run);

/// Moves the interior points. Where the patch meets the surface at less than 75 degrees, it leaves
/// the border tangentially and bends as little as possible inside, so parts of planes and spheres
/// are continued exactly. Along the rest of the border it meets the surface at a crease and
/// minimizes its area. `normals` are those of span_loop. Throws Error(kCancelled).
void fair_patch(std::span<const Vector3> normals, HolePatch* patch, const Run& run);

}  // namespace prefilter
