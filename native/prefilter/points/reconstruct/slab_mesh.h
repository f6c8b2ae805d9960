// SPDX-License-Identifier: GPL-3.0-or-later

// A slab's part of the surface: contoured, moved onto the samples, and trimmed.
#pragma once

#include <cstddef>

#include "prefilter/points/reconstruct.h"
#include "prefilter/points/reconstruct/fit_samples.h"
#include "prefilter/points/reconstruct/mesh_joiner.h"
#include "prefilter/points/reconstruct/sample_index.h"
#include "prefilter/points/reconstruct/slabs.h"
#include "prefilter/points/reconstruct/surface_level.h"

namespace prefilter {

/// What all parts of a surface have in common.
struct SurfaceSamples {
  const Slabs& slabs;
  std::size_t attribute_count = 0;
  SampleNoise noise;
  double cell = 1.0;  // the side of a finest one, in the points' units
};

/// The samples of depth `k` in slab `s` and up to `margin` cells of that depth away from it, but no
/// farther than the slabs next to it.
SampleIndex samples_around(const Slabs& slabs, int s, int k, int margin);

/// How noisy the samples are, from some cells of a slab. The slabs around it get their leaves.
SampleNoise find_noise(int s, Slabs* slabs);

/// The part in slab `s`. The values of the slab and of those next to it have been made.
SlabMesh mesh_of_slab(const SurfaceSamples& surface, const ReconstructOptions& options,
                      const SurfaceLevel& level, int s);

/// Marks the vertices of slab `s` that are farther than `limit` finest cells from all samples: from
/// the means of those in a cell, which is small beside the limit.
void mark_far_vertices(const Slabs& slabs, int s, double limit, SlabMesh* slab);

}  // namespace prefilter
