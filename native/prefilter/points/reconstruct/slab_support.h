// SPDX-License-Identifier: GPL-3.0-or-later

// Measures how well the samples support a slab's part of the surface.
#pragma once

#include "prefilter/points/reconstruct/slab_mesh.h"

namespace prefilter {

/// Appends the attributes of kSupportAttributes to each vertex of slab `s`. Also finds the edges
/// and triangles whose middles are far from all samples although their corners are near: without
/// samples the octree is coarse, and so are its facets across holes. The adjacent slabs must be at
/// kLeaves. `sign` is -1 where the samples' normals point inward.
void add_support(const SurfaceSamples& surface, double limit, double sign, int s, SlabMesh* slab);

}  // namespace prefilter
