// SPDX-License-Identifier: GPL-3.0-or-later

// Labels for all triangles of a mesh.
#pragma once

#include "prefilter/base/progress.h"
#include "prefilter/voxels/remesh/faceted_mesh.h"

namespace prefilter {

/// Gives triangles of kNoLabel the label of what they hang together with by edges that are no
/// creases; parts of the mesh without any get new ones. Returns how many labels there are new,
/// above `count`, the number of those that were there. Throws Error(kCancelled).
int spread_labels(FacetedMesh* mesh, std::int32_t count, const Progress& progress);

}  // namespace prefilter
