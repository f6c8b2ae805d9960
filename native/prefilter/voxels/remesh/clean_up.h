// SPDX-License-Identifier: GPL-3.0-or-later

// Contours without narrow triangles.
#pragma once

#include <limits>

#include "prefilter/base/progress.h"
#include "prefilter/voxels/remesh/faceted_mesh.h"

namespace prefilter {

/// What cleaning up may do to a surface, in lengths.
struct CleaningLimits {
  double crease;                                            // how far creases may move
  double height = std::numeric_limits<double>::infinity();  // and what is between them
};

/// Widens triangles whose smallest angle is below 16 degrees: leaves out one of their vertices, or
/// flips an edge. What is new is nearly as flat as what was there, and within the limit of what
/// each change replaces. Vertices that remain do not move.
///
/// Creases stay: a vertex on one is left out only where that keeps the crease within its limit, and
/// kCorner ones never are. Labels stay on their side of them; a
/// triangle of kNoLabel may get that of one beside it. No new triangle intersects another one. A
/// closed two-manifold stays one. The same for any number of threads; vertices that are near each
/// other should have indices that are, for several threads to be of use.
///
/// Sides from 1e-70 to 1e70. Throws Error(kCancelled).
FacetedMesh clean_up(FacetedMesh mesh, const CleaningLimits& limits, const Progress& progress,
                     int threads);

}  // namespace prefilter
