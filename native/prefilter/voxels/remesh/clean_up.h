// SPDX-License-Identifier: GPL-3.0-or-later

// Removes narrow triangles from contours.
#pragma once

#include <limits>

#include "prefilter/base/run.h"
#include "prefilter/voxels/remesh/faceted_mesh.h"

namespace prefilter {

/// Limits on how far cleaning up may move a surface, in lengths.
struct CleaningLimits {
  double crease;                                            // for creases
  double height = std::numeric_limits<double>::infinity();  // for the surface between them
};

/// Widens triangles whose smallest angle is below 16 degrees, by removing one of their vertices or
/// flipping an edge. Replacements are nearly as flat as the triangles they replace, and within the
/// limit of them. Remaining vertices do not move.
///
/// Creases are preserved: a vertex on one is only removed if the crease stays within its limit, and
/// kCorner vertices never are. Labels stay on their side of creases; a triangle of kNoLabel may get
/// a neighbor's label. No new triangle intersects another one. A closed two-manifold remains one.
/// The result does not depend on the number of threads; for parallelism, nearby vertices should
/// have nearby indices.
///
/// Side lengths may range from 1e-70 to 1e70. Throws Error(kCancelled).
FacetedMesh clean_up(FacetedMesh mesh, const CleaningLimits& limits, const Run& run);

}  // namespace prefilter
