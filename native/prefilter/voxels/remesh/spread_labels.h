// SPDX-License-Identifier: GPL-3.0-or-later

// Completes the labels of a mesh.
#pragma once

#include "prefilter/base/run.h"
#include "prefilter/voxels/remesh/faceted_mesh.h"

namespace prefilter {

/// Gives triangles of kNoLabel the label of triangles connected to them by edges; components
/// without any label get new ones. Returns the number of new labels, which start at `count`, the
/// number of existing ones. Throws Error(kCancelled).
int spread_labels(FacetedMesh* mesh, std::int32_t count, const Run& run);

}  // namespace prefilter
