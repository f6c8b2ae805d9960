// SPDX-License-Identifier: GPL-3.0-or-later

// Fewer triangles where the surface is flat or gently curved.
#pragma once

#include "prefilter/base/progress.h"
#include "prefilter/voxels/remesh/faceted_mesh.h"

namespace prefilter {

/// Removes vertices of a closed two-manifold, in units of its positions, such that each that is
/// removed stays within `tolerance` of the surface that remains, and that surface within it of the
/// one before. Vertices that remain do not move. Creases keep to their course within the tolerance,
/// and with them the borders of labels; vertices where creases meet or end stay. No triangle turns
/// by more than 30 degrees at a time. What comes out is a closed two-manifold of the same genus,
/// and does not intersect itself where the mesh did not; triangles and vertices come in another
/// order.
///
/// A tolerance of 0 returns the mesh as it is. Throws Error where the tolerance is negative or not
/// finite; Error(kCancelled).
FacetedMesh simplify(FacetedMesh mesh, double tolerance, const Progress& progress, int threads);

}  // namespace prefilter
