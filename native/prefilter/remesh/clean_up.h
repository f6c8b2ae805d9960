// Contours with fewer thin triangles.
#pragma once

#include "prefilter/base/geometry.h"
#include "prefilter/base/progress.h"

namespace prefilter {

/// Collapses edges that are much shorter than others of their triangles, onto the one of their ends
/// that leaves the better triangles. A collapse that would fold the surface, turn a triangle by
/// more than 45 degrees, or leave it less than a closed two-manifold is not made, so a mesh that is
/// one stays one. Vertices that remain do not move. Sides from 1e-70 to 1e70. Throws
/// Error(kCancelled).
TriangleMesh clean_up(TriangleMesh mesh, const Progress& progress, int threads);

}  // namespace prefilter
