// SPDX-License-Identifier: GPL-3.0-or-later

// Simplifies flat or gently curved parts of a mesh.
#pragma once

#include "prefilter/base/run.h"
#include "prefilter/voxels/remesh/faceted_mesh.h"

namespace prefilter {

/// Removes vertices of a closed two-manifold so that each removed vertex stays within `tolerance`,
/// in units of the positions, of the resulting surface, and that surface within it of the original.
/// Remaining vertices do not move. Creases, including the borders between labels, stay within the
/// tolerance too; vertices where creases meet or end remain. No triangle turns by more than 30
/// degrees at a time. The result is a closed two-manifold of the same genus, and does not intersect
/// itself unless the mesh did; the order of triangles and vertices changes.
///
/// A tolerance of 0 returns the mesh unchanged. Throws Error if the tolerance is negative or not
/// finite; Error(kCancelled).
FacetedMesh simplify(FacetedMesh mesh, double tolerance, const Run& run);

}  // namespace prefilter
