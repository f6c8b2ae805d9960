// SPDX-License-Identifier: GPL-3.0-or-later

// How well the samples support a slab's part of the surface.
#pragma once

#include "prefilter/points/reconstruct/slab_mesh.h"

namespace prefilter {

/// Adds to the attributes of each vertex of slab `s` those of kSupportAttributes, and finds which
/// edges and triangles lie far from all samples though their corners are near: an octree is coarse
/// where there are no samples, and so are its facets across holes. The slabs next to it have their
/// leaves.
/// `sign` is -1 where normals of samples point inward.
void add_support(const SurfaceSamples& surface, double limit, double sign, int s, SlabMesh* slab);

}  // namespace prefilter
